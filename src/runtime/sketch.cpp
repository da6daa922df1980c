#include "deltadyn/runtime/sketch.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

using Vec = Eigen::Vector3d;

/// The halves from their hinges to the limbs, and from hinge to hinge what joins them.
void add_articulated_plate(const RobotDescription& robot, const LinkPoses& at, SketchLines& halves, SketchLines& bars) {
  for (std::size_t i = 0; i < robot.limbs.size(); ++i)
    halves.lines.emplace_back(at.parts[static_cast<std::size_t>(robot.limbs[i].part)].place, at.limbs[i].plate);
  const double radius = robot.plate->pinion_radius;
  if (radius > 0) {
    constexpr int kCorners = 24;
    const auto corner = [&](int k) -> Vec {
      const double angle = 6.283185307179586 * k / kCorners;
      return at.plate + radius * Vec(std::cos(angle), std::sin(angle), 0);
    };
    for (int k = 0; k < kCorners; ++k) bars.lines.emplace_back(corner(k), corner(k + 1));
    // The racks, where they touch the pinion
    const Vec out = radius * robot.plate->outwards(), along = robot.plate->range * Vec::UnitZ().cross(out);
    for (const double side : {1.0, -1.0})
      halves.lines.emplace_back(at.plate + side * out - along, at.plate + side * out + along);
    return;
  }
  const Vec side = Vec::UnitZ().cross(robot.plate->outwards()) * robot.plate->bar_spacing / 2;
  for (const double sign : {1.0, -1.0})
    bars.lines.emplace_back(at.parts[0].place + sign * side, at.parts[1].place + sign * side);
}

}  // namespace

std::vector<SketchLines> sketch_of(const Robot& drawn, const Eigen::VectorXd& q) {
  const RobotDescription& robot = drawn.description();
  LinkPoses at;
  if (drawn.link_poses(q, at) != Status::ok)
    throw Error("the pose to be drawn is out of reach or singular", robot.name, "check the lengths in the robot file");
  const bool rails = robot.drive_kind == DriveKind::prismatic;
  SketchLines base{"base"}, arms{rails ? "rails" : "upper arms"}, struts{"struts"}, plate{"plate"},
      bars{robot.plate && robot.plate->pinion_radius > 0 ? "pinion" : "plate's bars"}, bar{"telescope bar"};
  const std::size_t limbs = robot.limbs.size();
  for (std::size_t i = 0; i < limbs; ++i) {
    const LimbGeometry<double>& limb = robot.limbs[i];
    if (limbs > 1) base.lines.emplace_back(limb.p_WD, robot.limbs[(i + 1) % limbs].p_WD);
    const LinkPoses::Limb& pose = at.limbs[i];
    arms.lines.emplace_back(limb.p_WD, pose.elbow);
    if (robot.parts.empty()) continue;
    const Vec across = 0.5 * limb.strut_spacing * pose.R_WL.col(1);
    for (const double side : {1.0, -1.0})
      struts.lines.emplace_back(pose.elbow + side * across, pose.plate + side * across);
    // The ends of a parallelogram, which make it one to the eye
    arms.lines.emplace_back(pose.elbow - across, pose.elbow + across);
    plate.lines.emplace_back(pose.plate - across, pose.plate + across);
    if (!robot.plate) plate.lines.emplace_back(at.plate, pose.plate);
  }
  if (robot.plate) add_articulated_plate(robot, at, plate, bars);
  if (robot.telescope) bar.lines.emplace_back(robot.telescope->p_WU, at.plate + robot.telescope->p_BV);
  std::vector<SketchLines> all;
  for (SketchLines* one : {&base, &arms, &struts, &plate, &bars, &bar})
    if (!one->lines.empty()) all.push_back(std::move(*one));
  return all;
}

}  // namespace deltadyn
