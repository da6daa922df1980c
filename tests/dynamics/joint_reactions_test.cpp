#include "deltadyn/dynamics/joint_reactions.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "support/drawn_motion.hpp"
#include "support/matchers.hpp"
#include "support/oracle_of.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

template <class R>
class Reactions : public ::testing::Test {
 protected:
  void draw() {
    drawn.next();
    ASSERT_EQ((joint_reactions<typename DrawnMotion<R>::Layout>(drawn.geometry, drawn.motion, drawn.p, loads)),
              Status::ok);
  }
  DrawnMotion<R> drawn{61};
  JointReactions<double, R> loads;
};
using Robots =
    ::testing::Types<Delta3, LinearDelta3, Delta4, H4, LinearH4, I4, LinearI4, Par4, LinearPar4, Axis, LinearAxis>;
TYPED_TEST_SUITE(Reactions, Robots);

// Principle of virtual power on one side, Newton and Euler on the other: the drives' share of the bearings' loads is
// the torque.
TYPED_TEST(Reactions, HoldTheDriveTorques) {
  using R = TypeParam;
  using Layout = typename DrawnMotion<R>::Layout;
  using Drives = typename DrawnMotion<R>::Drives;
  auto& d = this->drawn;
  for (int state = 0; state < 1000; ++state) {
    this->draw();
    const Drives tau = inverse_dynamics<Layout>(d.geometry, d.motion, d.p);
    Drives expected = tau, found;
    for (int i = 0; i < R::kDrives; ++i) {  // what the motor itself takes
      expected(i) -= d.p(Layout::viscous(i)) * d.motion.qd(i) +
                     d.p(Layout::coulomb(i)) * (d.motion.qd(i) > 0 ? 1 : -1) +
                     d.p(Layout::kRotorInertia + i) * d.motion.qdd(i) + d.p(Layout::kOffset + i);
    }
    for (int i = 0; i < R::kLimbs; ++i) {
      const Vector3<double> axis = limb_frame(d.geometry.limbs[i]) * d.geometry.limbs[i].axis_L;
      const auto& load = this->loads.limbs[i].drive;
      found(i) = axis.dot(R::kDrive == DriveKind::revolute ? load.moment : load.force);
    }
    if constexpr (R::kTelescope) found(R::kDrives - 1) = this->loads.telescope_base.moment.z();
    EXPECT_THAT(found, IsNear(expected, 1e-9 * (1 + tau.norm()))) << "state " << state;
  }
}

/// What a body needs beside its weight: force, and moment about the origin of W, from its pose as a function of time.
struct Needed {
  Vector3<double> force, moment;
};
Needed needed(const oracles::Pose<oracles::Dual<oracles::Dual<oracles::Real>>>& pose, const oracles::Ten& ten,
              const Vector3<double>& gravity) {
  using oracles::Real;
  Eigen::Matrix<Real, 3, 4> X, X_dd;  // of the points (x y z 1) of the body, and their accelerations
  for (int row = 0; row < 3; ++row) {
    for (int k = 0; k < 4; ++k) {
      const auto& entry = k < 3 ? pose.R(row, k) : pose.p(row);
      X(row, k) = entry.value.value;
      X_dd(row, k) = entry.slope.slope;
    }
    X_dd(row, 3) -= static_cast<Real>(gravity(row));
  }
  const Eigen::Matrix<Real, 3, 3> cross = X_dd * oracles::mass_moments(ten) * X.transpose();  // integral of a r^T
  const Eigen::Matrix<Real, 3, 1> force = (X_dd * oracles::mass_moments(ten)).col(3);
  const Eigen::Matrix<Real, 3, 1> moment(cross(2, 1) - cross(1, 2), cross(0, 2) - cross(2, 0),
                                         cross(1, 0) - cross(0, 1));
  return {force.cast<double>(), moment.cast<double>()};
}

void add(const JointLoad<double>& load, double sign, Needed& sum) {
  sum.force += sign * load.force;
  sum.moment += sign * (load.moment + load.place.cross(load.force));
}

// Every body of the drawing in equilibrium with its joints, its weight and its inertia.
TYPED_TEST(Reactions, BalanceEveryBody) {
  using R = TypeParam;
  using Layout = typename DrawnMotion<R>::Layout;
  auto& d = this->drawn;
  for (int state = 0; state < 100; ++state) {
    this->draw();
    auto mechanism = oracle_of(d.geometry);
    auto bodies = oracles::poses(mechanism, in_time(d.motion.posture.q, d.motion.qd, d.motion.qdd), numbers(d.task.z));
    const auto load = load_of<R, Layout>(d.p);
    std::vector<Needed> balance(bodies.size(), {Vector3<double>::Zero(), Vector3<double>::Zero()});
    const std::size_t in_a_limb = kHasPlate<R> ? 3 : 1;
    const std::size_t plate = in_a_limb * R::kLimbs;
    for (std::size_t i = 0; i < R::kLimbs; ++i) {
      const auto& limb = this->loads.limbs[i];
      add(limb.drive, 1, balance[in_a_limb * i]);
      for (std::size_t k = 0; k < 2 && kHasPlate<R>; ++k) {
        add(limb.elbow[k], -1, balance[in_a_limb * i]);
        add(limb.elbow[k], 1, balance[in_a_limb * i + 1 + k]);
        add(limb.plate[k], -1, balance[in_a_limb * i + 1 + k]);
        add(limb.plate[k], 1, balance[plate + static_cast<std::size_t>(d.geometry.limbs[static_cast<int>(i)].part)]);
        EXPECT_EQ(limb.plate[k].moment, Vector3<double>::Zero());  // ball joints
      }
    }
    if constexpr (R::kTelescope) {
      // The tool's frame lies on its axis, above the bar's lower joint.
      for (int k = 0; k < 2; ++k)
        bodies[plate + 1].p(k).value.value += static_cast<oracles::Real>(d.geometry.telescope.p_BV(k));
      add(this->loads.tool_bearing, -1, balance[plate]);
      add(this->loads.tool_bearing, 1, balance[plate + 1]);
      add(this->loads.telescope_tool, 1, balance[plate + 1]);
      add(this->loads.telescope_base, 1, balance[plate + 2]);
      add(this->loads.telescope_slide, -1, balance[plate + 2]);
      add(this->loads.telescope_slide, 1, balance[plate + 3]);
      add(this->loads.telescope_tool, -1, balance[plate + 3]);
      EXPECT_NEAR(this->loads.tool_bearing.moment.z(), 0, 1e-9);
      const double rate = d.motion.telescope.length_d;
      const double friction =
          d.p(Layout::viscous(R::kDrives)) * rate + d.p(Layout::coulomb(R::kDrives)) * (rate > 0 ? 1 : -1);
      EXPECT_NEAR(this->loads.telescope_slide.force.dot(d.motion.posture.telescope.e), friction,
                  1e-9 * (1 + std::abs(friction)));
    }
    std::vector<Needed> needs;
    for (std::size_t b = 0; b < bodies.size(); ++b)
      needs.push_back(needed(bodies[b], load.bodies[b], d.geometry.gravity));
    if constexpr (R::kPlateTurns) {
      // All that stands between the halves counts as one body.
      for (std::size_t b = bodies.size() - 1; b > plate + 2; --b) {
        needs[plate + 2].force += needs[b].force;
        needs[plate + 2].moment += needs[b].moment;
        needs.pop_back();
      }
      for (std::size_t k = 0; k < 2; ++k) {
        add(this->loads.half_plate[k], 1, balance[plate + k]);
        add(this->loads.half_plate[k], -1, balance[plate + 2]);
      }
      // Friction and gear of a hinge give the same to both halves; where the halves are parallel, nothing says so.
      if (halves_turn_apart<R>()) {
        EXPECT_NEAR(this->loads.half_plate[0].moment.z(), this->loads.half_plate[1].moment.z(), 1e-9);
      }
    }
    for (std::size_t b = 0; b < needs.size(); ++b) {
      const Needed& need = needs[b];
      const double size = 1 + d.p.norm() * (d.motion.qdd.norm() + d.motion.qd.squaredNorm());
      EXPECT_THAT(balance[b].force, IsNear(need.force, 1e-9 * size)) << "state " << state << ", body " << b;
      EXPECT_THAT(balance[b].moment, IsNear(need.moment, 1e-9 * size)) << "state " << state << ", body " << b;
    }
  }
}

// A symmetric Delta at rest in the middle: each of the six struts carries a sixth of what hangs on them.
TEST(ReactionsAtRest, ShareTheWeightOfThePlate) {
  Geometry<double, Delta3> geometry;
  using Layout = ParameterLayout<Delta3, Limbs::shared>;
  for (int i = 0; i < 3; ++i) {
    auto& limb = geometry.limbs[i];
    limb.azimuth = i * 2.0943951023931953;
    const Matrix3<double> R_WL = rot_z(SinCos<double>(limb.azimuth));
    limb.p_WD = R_WL * Vector3<double>(0.2, 0, 0);
    limb.p_DE_0 = Vector3<double>(0.5, 0, 0);
    limb.p_BA = R_WL * Vector3<double>(0.05, 0, 0);
    limb.strut = 1.1;
  }
  Vector<double, Layout::kColumns> p = Vector<double, Layout::kColumns>::Zero();
  p(kInertialParameters * Layout::body(Body::platform, 0)) = 6;  // kg
  Motion<double, Delta3> motion;
  const Vector3<double> zero = Vector3<double>::Zero();
  ASSERT_EQ(motion_from_drives(geometry, zero, zero, zero, motion), Status::ok);
  JointReactions<double, Delta3> loads;
  ASSERT_EQ(joint_reactions<Layout>(geometry, motion, p, loads), Status::ok);
  for (const auto& limb : loads.limbs) {
    for (const double axial : limb.axial) EXPECT_NEAR(axial * -motion.posture.limbs[0].u.z(), 9.81, 1e-12);
  }
}

}  // namespace
}  // namespace deltadyn
