#include "deltadyn/runtime/workspace.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "deltadyn/runtime/articulated_plate.hpp"
#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/random.hpp"

#include "pose_check.hpp"

namespace deltadyn {

namespace {

constexpr double kTurnRange = 3.0;   // of a telescope drive, rad
constexpr double kPlateShare = 0.8;  // of the range of an articulated plate

/// A drive position in the middle of its limits, 0 if it has none.
double middle(const DriveLimits& limits) {
  return std::isfinite(limits.lower) && std::isfinite(limits.upper) ? (limits.lower + limits.upper) / 2 : 0.0;
}

constexpr double kShareOfArm = 0.5;          // that moves of the machine take
constexpr double kShareOfStrut = 0.4;        // the same on rails, where there is no arm, if they reach so far
constexpr double kLeastShareOfStrut = 0.25;  // of moves on rails, part of which may then be out of reach
constexpr double kRoom = 0.8;                // of the way to where the reach ends

/// Size of the moves about a place [m]: a share of the arm; on rails of the strut, or of what the reach allows.
double move_size(const Robot& robot, const Eigen::Vector3d& centre) {
  const LimbGeometry<double>& limb = robot.description().limbs.front();
  if (robot.description().drive_kind == DriveKind::revolute) return kShareOfArm * limb.p_DE_0.norm();
  // Rails differ more than arms do in how far they reach beside their struts, so that this is looked at: towards the
  // faces and the corners of a cube.
  constexpr double kStep = 0.02;
  const double longest = kShareOfStrut * limb.strut;
  double shortest = longest / kRoom;
  PoseCheck check(robot);
  for (int k = 0; k < 27; ++k) {
    const Eigen::Vector3d towards(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    if (towards.cwiseAbs().sum() == 2 || towards.isZero()) continue;
    double way = 0;
    while (way < shortest &&
           check.condition(centre + (way + kStep * limb.strut) * towards.normalized()) < kLargestCondition)
      way += kStep * limb.strut;
    shortest = std::min(shortest, way);
  }
  return std::max(kRoom * shortest, kLeastShareOfStrut * limb.strut);
}

}  // namespace

double plate_condition(const RobotDescription& robot, const Eigen::MatrixXd& J) {
  const auto limbs = static_cast<Eigen::Index>(robot.limbs.size());
  Eigen::MatrixXd plate = J.topLeftCorner(limbs, limbs);
  if (robot.plate) {
    const PlatePart<double>& half = robot.parts.front();
    plate.row(3) *= (half.a.norm() + half.b.norm()) / robot.plate->ratio;
  }
  const Eigen::VectorXd sizes = dense::singular_values(plate);
  return sizes(limbs - 1) > 0 ? sizes(0) / sizes(limbs - 1) : std::numeric_limits<double>::infinity();
}

WorkspaceSampler::WorkspaceSampler(const Robot& robot, std::uint64_t seed) : robot_(robot), random_(seed) {
  const RobotDescription& description = robot.description();
  if (description.parts.empty()) return;  // an axis has no plate
  const int n = robot.drives();
  const auto limbs = static_cast<Eigen::Index>(description.limbs.size());
  Eigen::VectorXd q(n), z(n);
  for (int i = 0; i < n; ++i) q(i) = middle(description.limits[static_cast<std::size_t>(i)]);
  // The middle of wide limits may be out of reach; then look for a regular pose with all limbs alike.
  bool found = regular(q);
  for (int k = 0; !found && k < 81; ++k) {
    const double share = (k % 2 == 0 ? 1 : -1) * ((k + 1) / 2) / 40.0;
    const double reach = description.drive_kind == DriveKind::revolute ? 1.5 : 2.0 * description.limbs.front().strut;
    q.head(limbs).setConstant(share * reach);
    found = regular(q);
  }
  if (!found || robot.forward_kinematics(q, z) != Status::ok) {
    throw Error("no regular pose of the robot was found", description.name,
                widest_gap(description.limbs) > 0.99 * std::numbers::pi
                    ? "all limbs stand on one side of the plate, which then nothing holds: spread them around it, so "
                      "that neighbours are less than 180 deg apart"
                    : "check the lengths in the robot file");
  }
  ball_.centre = z.head<3>();
  ball_.radius = move_size(robot, ball_.centre);
}

double WorkspaceSampler::uniform(double lower, double upper) {
  return lower + (upper - lower) * unit_of_53_bits(random_);
}

bool WorkspaceSampler::regular(const Eigen::VectorXd& q) const {
  const int n = robot_.drives();
  Eigen::MatrixXd J(n, n);
  if (robot_.jacobian(q, J) != Status::ok) return false;
  return plate_condition(robot_.description(), J) < kLargestCondition;
}

void WorkspaceSampler::draw_task(TaskState& task) {
  const int n = robot_.drives();
  const double size = ball_.radius;
  task.z.resize(n);
  task.zd.resize(n);
  task.zdd.resize(n);
  for (int i = 0; i < n; ++i) {
    const double turn = robot_.description().plate ? kPlateShare * robot_.description().plate_yaw_range() : kTurnRange;
    const double scale = i < 3 ? size : turn;
    task.z(i) = scale * uniform(-1, 1);
    task.zd(i) = 10 * scale * uniform(-1, 1);
    task.zdd(i) = 100 * scale * uniform(-1, 1);
  }
}

void WorkspaceSampler::next(Eigen::VectorXd& q, Eigen::VectorXd& qd, Eigen::VectorXd& qdd) {
  const int n = robot_.drives();
  q.resize(n);
  qd.resize(n);
  qdd.resize(n);
  if (robot_.description().parts.empty()) {
    for (int i = 0; i < n; ++i) {
      q(i) = uniform(-1, 1);
      qd(i) = uniform(-5, 5);
      qdd(i) = uniform(-50, 50);
    }
    return;
  }
  TaskState task;
  for (int attempt = 0; attempt < 100000; ++attempt) {
    draw_task(task);
    if (task.z.head<3>().squaredNorm() > ball_.radius * ball_.radius) continue;
    task.z.head<3>() += ball_.centre;
    if (robot_.to_drives(task, q, qd, qdd) == Status::ok && regular(q)) return;
  }
  throw Error("the workspace of the robot has hardly any regular pose", robot_.description().name,
              "check the lengths in the robot file");
}

void WorkspaceSampler::next(Eigen::VectorXd& q) {
  Eigen::VectorXd qd, qdd;
  next(q, qd, qdd);
}

}  // namespace deltadyn
