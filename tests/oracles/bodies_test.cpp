// Robots with an articulated plate against free bodies that nothing but their joints hold: where the bodies are, how
// the plate moves, the mass matrix and the torques.

#include "oracles/bodies.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <gtest/gtest.h>
#include <map>
#include <optional>

#include "deltadyn/dynamics/inverse_dynamics.hpp"
#include "deltadyn/dynamics/mass_matrix.hpp"
#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/runtime/geometry_of.hpp"

#include "oracles/four_limbs.hpp"
#include "support/descriptions.hpp"
#include "support/drawing_of.hpp"
#include "support/matchers.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;
using oracles::Real;
using oracles::bodies::Flight;
using oracles::bodies::FourLimbs;
using oracles::bodies::Real3;

constexpr double kAgreement = 1e-8;  ///< of every quantity, as a share of its size

template <class R>
class ArticulatedPlate : public ::testing::Test {
 protected:
  using Drives = Vector<double, R::kDrives>;

  /// A fresh robot, for the library and in bodies.
  void draw_robot() {
    geometry = random_geometry<R>(random);
    const PlateShape shape = random_shape<R>(random);
    set_plate(shape, geometry);
    in_bodies.emplace(drawing_of(geometry, shape));
  }

  /// A fresh state of it; the turn of the plate comes as far as the range of the shape.
  void draw_state() {
    task = random_task<R>(random, geometry.yaw_ratio);
    task.z(3) = geometry.yaw_ratio * random.uniform(-0.6, 0.6);
    ASSERT_EQ(motion_from_task(geometry, task.z, task.zd, task.zdd, motion), Status::ok);
    // The bodies learn of the plate no more than that it is somewhere near by.
    const Real3 near = (task.z.template head<3>() + random.cube(0.02)).template cast<Real>();
    const double theta = task.z(3) / geometry.yaw_ratio + random.uniform(-0.1, 0.1);
    const auto q = numbers(motion.posture.q);
    const auto at = oracles::bodies::assemble(in_bodies->system(), q, in_bodies->guess(q, near, Real(theta)));
    flight = oracles::bodies::fly(in_bodies->system(), at, numbers(motion.qd), numbers(motion.qdd));
  }

  void expect_plate() {
    Drives z, zd, zdd;
    const auto plate = in_bodies->plate(flight);
    for (int k = 0; k < 4; ++k) {
      const auto& y = plate[static_cast<std::size_t>(k)];
      z(k) = static_cast<double>(y.value.value);
      zd(k) = static_cast<double>(y.value.slope);
      zdd(k) = static_cast<double>(y.slope.slope);
    }
    expect("z", motion.posture.z, z, 1);
    expect("zd", motion.zd, zd, zd.norm());
    expect("zdd", motion.zdd, zdd, zdd.norm());
  }

  /// Orientation and origin of every part of the plate, which stand in the same order in the bodies.
  void expect_parts() {
    for (int k = 0; k < R::kPlateParts; ++k) {
      const PartPose<double> part = part_pose(geometry.parts[k], motion.posture.z(3), geometry.yaw_ratio);
      const Vector3<double> origin = motion.posture.z.template head<3>() + part.p.value;
      const auto& body = flight.at[in_bodies->half(static_cast<std::size_t>(k))];
      expect("R", rot_z(part.angle), body.R.template cast<double>().eval(), 1);
      expect("p", origin, body.p.template cast<double>().eval(), 1);
    }
  }

  template <Limbs kSharing>
  void expect_dynamics() {
    using Layout = ParameterLayout<R, kSharing>;
    const auto p = random_parameters<Layout>(random);
    const oracles::Load load = load_of<R, Layout>(p);
    const auto M = oracles::bodies::mass_matrix(in_bodies->system(), flight, load).template cast<double>().eval();
    const auto torque = oracles::bodies::drive_torque(in_bodies->system(), flight, load).template cast<double>().eval();
    expect("M", mass_matrix<Layout>(geometry, motion.posture, p), M, M.norm());
    expect("torque", inverse_dynamics<Layout>(geometry, motion, p), torque, torque.norm());
  }

  template <class A, class B>
  void expect(const std::string& name, const A& library, const B& oracle, double size) {
    EXPECT_THAT(library, IsNear(oracle, kAgreement * size)) << name << ", state " << state;
    largest[name] = std::max(largest[name], (library - oracle).cwiseAbs().maxCoeff() / size);
  }

  void TearDown() override {
    for (const auto& [name, difference] : largest) this->RecordProperty(name, print(Vector<double, 1>(difference)));
  }

  Random random{20090609};
  Geometry<double, R> geometry;
  std::optional<FourLimbs> in_bodies;
  RandomTask<R> task;
  Motion<double, R> motion;
  Flight flight;
  int state = 0;
  std::map<std::string, double> largest;  ///< relative differences
};

using Articulated = ::testing::Types<H4, LinearH4, I4, LinearI4, Par4, LinearPar4>;
TYPED_TEST_SUITE(ArticulatedPlate, Articulated);

TYPED_TEST(ArticulatedPlate, MovesAndWeighsAsItsBodies) {
  constexpr int kRobots = 25, kStates = 40;
  for (int robot = 0; robot < kRobots; ++robot) {
    this->draw_robot();
    for (int k = 0; k < kStates && !this->HasFailure(); ++k, ++this->state) {
      ASSERT_NO_FATAL_FAILURE(this->draw_state());
      this->expect_plate();
      this->expect_parts();
      this->template expect_dynamics<Limbs::individual>();
      this->template expect_dynamics<Limbs::shared>();
    }
  }
}

// The torques of unit parameters over random states: as many of them are independent as the library has combinations.
TYPED_TEST(ArticulatedPlate, ShowsAsManyCombinationsOfBodiesAsTheLibrarySays) {
  using R = TypeParam;
  using Layout = ParameterLayout<R, Limbs::shared>;
  constexpr int kStates = 30, kBodyColumns = kInertialParameters * Layout::kBodies;
  const RobotDescription robot = four_limb_description(R::kName, R::kDrive);
  this->geometry = geometry_of<double, R>(robot);
  this->in_bodies.emplace(drawing_of(this->geometry, *robot.plate));
  Eigen::MatrixXd W(4 * kStates, kBodyColumns);
  for (int k = 0; k < kStates; ++k) {
    ASSERT_NO_FATAL_FAILURE(this->draw_state());
    for (int column = 0; column < kBodyColumns; ++column) {
      const Vector<double, Layout::kColumns> unit = Vector<double, Layout::kColumns>::Unit(column);
      W.block<4, 1>(4 * k, column) =
          oracles::bodies::drive_torque(this->in_bodies->system(), this->flight, load_of<R, Layout>(unit))
              .template cast<double>();
    }
  }
  const double widest = W.colwise().norm().maxCoeff();
  for (int column = 0; column < kBodyColumns; ++column) {
    const double size = W.col(column).norm();
    W.col(column) *= size > 1e-9 * widest ? 1 / size : 0.0;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(1e-9);
  const int friction = 2 * Layout::kFrictionJoints;
  EXPECT_EQ(qr.compute(W).rank() + friction, find_base_parameters(*make_robot(robot)).count());
}

/// Rank of the joints' equations, with or without those that hold the drives.
Eigen::Index rank(const oracles::bodies::System& system, const oracles::bodies::Places& at, bool drives_held) {
  Eigen::MatrixXd J = oracles::bodies::Block(oracles::bodies::jacobian(system, at)).cast<double>();
  for (Eigen::Index row = 0; row < J.rows() && !drives_held; ++row) {
    if (system.equations[static_cast<std::size_t>(row)].drive >= 0) J.row(row).setZero();
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(1e-9);
  return qr.compute(J).rank();
}

// Free drives leave exactly four motions, held ones none: the joints hold the halves level, too.
TYPED_TEST(ArticulatedPlate, IsHeldByItsDrives) {
  for (int robot = 0; robot < 5; ++robot) {
    this->draw_robot();
    ASSERT_NO_FATAL_FAILURE(this->draw_state());
    const auto& system = this->in_bodies->system();
    EXPECT_EQ(rank(system, this->flight.at, true), system.unknowns());
    EXPECT_EQ(rank(system, this->flight.at, false), system.unknowns() - 4);
  }
}

// Two parallelograms leave a half plate one turn, about the line across both of their normals. In an H4 with all limbs
// alike at 45, 135, 225 and 315 degrees these lines lie over the crossbar, so both halves may tip about it together and
// turn opposite ways on their hinges. The slide and the planar parallelogram of the others forbid the latter.
template <class R>
double least_singular_value() {
  Geometry<double, R> geometry;
  PlateShape shape;
  shape.spacing = 0.12;
  shape.bar_spacing = 0.08;
  shape.pinion_radius = 0.04;
  set_plate(shape, geometry);
  for (int i = 0; i < 4; ++i) {
    LimbGeometry<double>& limb = geometry.limbs[i];
    limb.azimuth = (0.25 + 0.5 * i) * 3.14159265358979323846;
    const Matrix3<double> R_WL = rot_z(SinCos<double>(limb.azimuth));
    limb.p_WD = R_WL * Vector3<double>(0.25, 0, 0);
    limb.p_DE_0 = Vector3<double>(0.45, 0, 0);
    limb.p_BA = R_WL * Vector3<double>(0.06, 0, 0);
  }
  const Vector<double, 4> z(0, 0, -0.85, 0);
  Vector<double, 4> q;
  EXPECT_EQ(inverse_kinematics(geometry, z, q), Status::ok);
  const FourLimbs robot(drawing_of(geometry, shape));
  const auto at = robot.guess(numbers(q), z.head<3>().cast<Real>(), 0);  // with the plate in the middle, the very place
  EXPECT_LT(oracles::bodies::errors(robot.system(), at, numbers(q)).cwiseAbs().maxCoeff(), 1e-15L);
  const Eigen::MatrixXd J = oracles::bodies::Block(oracles::bodies::jacobian(robot.system(), at)).cast<double>();
  return Eigen::BDCSVD<Eigen::MatrixXd>(J).singularValues().minCoeff();
}

TEST(Halves, OfAnH4TipAboutTheCrossbarIfTheLimbsStandInASquare) {
  EXPECT_LT(least_singular_value<H4>(), 1e-12);
  EXPECT_GT(least_singular_value<I4>(), 1e-3);
  EXPECT_GT(least_singular_value<Par4>(), 1e-3);
}

// Closure of a Par4 as others publish it (ROBNUX/arm_kinematics_trajectory, MIT). There psi is the direction from the
// hinges of limbs 1 and 2 to those of 3 and 4, so half plate 1 lies at psi + pi. Limbs 1 and 2 stand at -90 and 0
// degrees; half plate 1 points between them at theta = 0, so psi + pi = -pi/4 + theta, and theta = psi - 3 pi / 4 but
// for a full turn. Rods end at their hinge minus v: -v is the attachment. Arms turn down, as here.
class PublishedPar4 : public ::testing::Test {
 protected:
  static constexpr double kPi = 3.14159265358979323846;
  struct Pose {
    double x, y, z, psi, q[4];
  };
  static constexpr Pose kPoses[] = {
      {0, 0, -0.45, 0.75 * kPi, {-0.051727090, 0.204886353, 0.204886353, -0.051727090}},
      {0.05, 0.05, -0.45, 0.75 * kPi, {0.070263920, 0.041580336, 0.041580336, 0.070263920}},
      {0.05, -0.02, -0.5, 2.0, {0.117023778, 0.352136478, 0.432493693, 0.362251535}}};

  PublishedPar4() {
    shape.azimuth = -kPi / 4;
    shape.spacing = 0.127;
    shape.bar_spacing = 0.06;  // of no account for where the plate is
    shape.ratio = 4;           // likewise
    set_plate(shape, geometry);
    for (int i = 0; i < 4; ++i) {
      LimbGeometry<double>& limb = geometry.limbs[i];
      limb.azimuth = -kPi / 2 + i * kPi / 2;
      limb.p_WD = 0.15 * Vector3<double>(std::cos(limb.azimuth), std::sin(limb.azimuth), 0);
      limb.p_DE_0 = Vector3<double>(0.2, 0, 0);
      limb.strut = 0.51;
      limb.p_BA = i == 0 || i == 3 ? Vector3<double>(-0.09, -0.09, 0) : Vector3<double>::Zero();
    }
  }
  [[nodiscard]] Vector<double, 4> task(const Pose& pose) const {
    return {pose.x, pose.y, pose.z, shape.ratio * (pose.psi - 0.75 * kPi)};
  }

  PlateShape shape;
  Geometry<double, Par4> geometry;
};

TEST_F(PublishedPar4, ClosesInTheLibrary) {
  for (const Pose& pose : kPoses) {
    const Vector<double, 4> published = Eigen::Map<const Vector<double, 4>>(pose.q);
    Vector<double, 4> q, back;
    ASSERT_EQ(inverse_kinematics(geometry, task(pose), q), Status::ok);
    EXPECT_THAT(q, IsNear(published, 1e-8));
    ASSERT_EQ(forward_kinematics(geometry, q, back), Status::ok);
    EXPECT_THAT(back, IsNear(task(pose), 1e-8));
  }
}

TEST_F(PublishedPar4, ClosesInBodies) {
  const FourLimbs robot(drawing_of(geometry, shape));
  for (const Pose& pose : kPoses) {
    const auto q = numbers(Eigen::Map<const Vector<double, 4>>(pose.q));
    const oracles::Numbers still(4, 0);
    const Vector<double, 4> near = task(pose) + Vector<double, 4>(0.01, -0.01, 0.01, 0.2);
    const auto guess = robot.guess(q, near.head<3>().cast<Real>(), Real(near(3) / shape.ratio));
    const auto at = oracles::bodies::assemble(robot.system(), q, guess);
    const auto plate = robot.plate(oracles::bodies::fly(robot.system(), at, still, still));
    for (int k = 0; k < 4; ++k) {
      // Nine digits were published, from which the short arms of the plate make eight, and the gear multiplies theta.
      EXPECT_NEAR(static_cast<double>(oracles::base(plate[static_cast<std::size_t>(k)])), task(pose)(k), 1e-7);
    }
  }
}

}  // namespace
}  // namespace deltadyn
