#include "deltadyn/dynamics/inverse_dynamics.hpp"

#include <gtest/gtest.h>

#include "deltadyn/dynamics/mass_matrix.hpp"

#include "support/drawn_motion.hpp"
#include "support/matchers.hpp"
#include "support/oracle_of.hpp"
#include "support/posture_at.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

template <class R>
class InverseDynamics : public ::testing::Test {
 protected:
  using Columns = typename DrawnMotion<R>::Layout;
  using Parameters = Vector<double, Columns::kColumns>;

  typename DrawnMotion<R>::Drives torque(const Parameters& parameters) const {
    return inverse_dynamics<Columns>(drawn.geometry, drawn.motion, parameters);
  }
  double size() const {
    Matrix<double, R::kDrives, Columns::kColumns> Y;
    regressor<Columns>(drawn.geometry, drawn.motion, Y);
    return (Y.cwiseAbs() * drawn.p.cwiseAbs()).maxCoeff();
  }

  DrawnMotion<R> drawn{7};
};
TYPED_TEST_SUITE(InverseDynamics, AllRobots);

template <class R, Limbs kSharing>
void expect_regressor_times_parameters(Random& random) {
  using Layout = ParameterLayout<R, kSharing>;
  for (int trial = 0; trial < 200; ++trial) {
    const auto geometry = random_geometry<R>(random);
    const auto task = random_task<R>(random);
    const auto p = random_parameters<Layout>(random);
    Motion<double, R> motion;
    ASSERT_EQ(motion_from_task(geometry, task.z, task.zd, task.zdd, motion), Status::ok);
    Matrix<double, R::kDrives, Layout::kColumns> Y;
    regressor<Layout>(geometry, motion, Y);
    const double size = (Y.cwiseAbs() * p.cwiseAbs()).maxCoeff();
    EXPECT_THAT(inverse_dynamics<Layout>(geometry, motion, p), IsNear((Y * p).eval(), 1e-13 * size))
        << "trial " << trial;
  }
}

TYPED_TEST(InverseDynamics, IsTheRegressorTimesTheParameters) {
  auto& d = this->drawn;
  expect_regressor_times_parameters<TypeParam, Limbs::shared>(d.random);
  expect_regressor_times_parameters<TypeParam, Limbs::individual>(d.random);
}

TYPED_TEST(InverseDynamics, IsLinearInTheParameters) {
  auto& d = this->drawn;
  d.next();
  const auto other = random_parameters<typename DrawnMotion<TypeParam>::Layout>(d.random);
  const auto sum = this->torque(2.5 * d.p - 0.75 * other);
  EXPECT_THAT(sum, IsNear((2.5 * this->torque(d.p) - 0.75 * this->torque(other)).eval(), 1e-11 * this->size()));
}

TYPED_TEST(InverseDynamics, AtRestIsTheGradientOfThePotentialPlusOffsets) {
  using Layout = typename DrawnMotion<TypeParam>::Layout;
  auto& d = this->drawn;
  for (int trial = 0; trial < 30; ++trial) {
    d.next();
    const auto& q = d.motion.posture.q;
    const auto load = load_of<TypeParam, Layout>(d.p);
    const auto gradient = to_vector<TypeParam::kDrives>(
        oracles::gravity_torque(oracle_of(d.geometry), load, numbers(q), numbers(d.task.z)));
    const auto still = Vector<double, TypeParam::kDrives>::Zero().eval();
    set_drive_rates<double, TypeParam>(d.geometry, still, still, d.motion);
    const auto offsets = d.p.template tail<TypeParam::kDrives>();
    EXPECT_THAT(this->torque(d.p), IsNear((gradient + offsets).eval(), 1e-12 * this->size()));
  }
}

TYPED_TEST(InverseDynamics, ScalesAccelerationAndVelocityTorqueAsRigidBodiesDo) {
  using Drives = typename DrawnMotion<TypeParam>::Drives;
  auto& d = this->drawn;
  d.next();
  // Without friction and offset: tau(s qd, s^2 qdd) - tau(0, 0) = s^2 (tau(qd, qdd) - tau(0, 0)).
  d.p.template tail<DrawnMotion<TypeParam>::Layout::kColumns - DrawnMotion<TypeParam>::Layout::kRotorInertia>()
      .setZero();
  d.p.template segment<2 * DrawnMotion<TypeParam>::Layout::kFrictionJoints>(DrawnMotion<TypeParam>::Layout::kFriction)
      .setZero();
  const Drives qd = d.motion.qd, qdd = d.motion.qdd;
  const auto torque_at = [&](const Drives& velocity, const Drives& acceleration) {
    set_drive_rates<double, TypeParam>(d.geometry, velocity, acceleration, d.motion);
    return this->torque(d.p);
  };
  const Drives rest = torque_at(Drives::Zero(), Drives::Zero());
  const Drives slow = torque_at(qd, qdd) - rest;
  const Drives fast = torque_at(3 * qd, 9 * qdd) - rest;
  EXPECT_THAT(fast, IsNear((9 * slow).eval(), 1e-10 * this->size()));
}

// d/dt (kinetic + potential energy) = qd^T tau - what friction and the offsets take. The time derivative is numeric.
TYPED_TEST(InverseDynamics, BalancesThePowerAlongAMotion) {
  using Layout = typename DrawnMotion<TypeParam>::Layout;
  using Drives = typename DrawnMotion<TypeParam>::Drives;
  auto& d = this->drawn;
  for (int trial = 0; trial < 10; ++trial) {
    d.next();
    const Drives q = d.motion.posture.q, qd = d.motion.qd, qdd = d.motion.qdd;
    const auto mechanism = oracle_of(d.geometry);
    const auto load = load_of<TypeParam, Layout>(d.p);
    const auto energy = [&](double t) {
      const Drives q_t = q + t * qd + t * t / 2 * qdd;
      const Drives qd_t = qd + t * qdd;
      Posture<double, TypeParam> posture;
      EXPECT_EQ(posture_at(d.geometry, q_t, d.task.z, posture), Status::ok);
      const auto M = mass_matrix<Layout>(d.geometry, posture, d.p);
      return 0.5 * qd_t.dot(M * qd_t) +
             static_cast<double>(oracles::potential_energy(mechanism, load, numbers(q_t), numbers(d.task.z)));
    };
    const double h = 1e-4;
    const double rate = (8 * (energy(h) - energy(-h)) - (energy(2 * h) - energy(-2 * h))) / (12 * h);
    const double heat =
        static_cast<double>(oracles::friction_power(mechanism, load, numbers(q), numbers(qd), numbers(d.task.z)));
    const double offset = qd.dot(d.p.template tail<TypeParam::kDrives>());
    const double power = qd.dot(this->torque(d.p));
    EXPECT_NEAR(rate, power - heat - offset, 1e-8 * this->size() * qd.norm());
    EXPECT_GT(heat, 0);
  }
}

/// Geometry that looks the same after a turn by 120 degrees.
template <class R>
Geometry<double, R> symmetric_geometry() {
  Geometry<double, R> geometry;
  for (int i = 0; i < 3; ++i) {
    LimbGeometry<double>& limb = geometry.limbs[i];
    limb.azimuth = i * 2.0943951023931953;
    const Matrix3<double> R_WL = rot_z(SinCos<double>(limb.azimuth));
    limb.p_BA = R_WL * Vector3<double>(0.05, 0, 0);
    limb.strut = 1.1;
    limb.p_WD = R_WL * Vector3<double>(R::kDrive == DriveKind::revolute ? 0.2 : 0.45, 0, 0);
    if (R::kDrive == DriveKind::revolute) {
      limb.p_DE_0.x() = 0.5;
    } else {
      limb.axis_L = -Vector3<double>::UnitZ();
    }
  }
  geometry.telescope.p_BV.z() = 0.02;
  return geometry;
}

template <class R>
class ThreefoldSymmetry : public ::testing::Test {};
using SymmetricRobots = ::testing::Types<Delta3, LinearDelta3, Delta4>;
TYPED_TEST_SUITE(ThreefoldSymmetry, SymmetricRobots);

// The same motion one limb further on: torques move on by one limb, the fourth drive turns by 120 degrees and feels the
// same.
TYPED_TEST(ThreefoldSymmetry, PermutesTheTorques) {
  using R = TypeParam;
  using Layout = ParameterLayout<R, Limbs::shared>;
  using Drives = Vector<double, R::kDrives>;
  const auto geometry = symmetric_geometry<R>();
  Random random(11);
  for (int trial = 0; trial < 50; ++trial) {
    auto p = random_parameters<Layout>(random);
    for (int joint = 1; joint < 3; ++joint) {
      p(Layout::viscous(joint)) = p(Layout::viscous(0));
      p(Layout::coulomb(joint)) = p(Layout::coulomb(0));
      p(Layout::kRotorInertia + joint) = p(Layout::kRotorInertia);
      p(Layout::kOffset + joint) = p(Layout::kOffset);
    }
    const auto task = random_task<R>(random);
    const auto turned = [](const Drives& v) {
      Drives out = v;
      for (int i = 0; i < 3; ++i) out((i + 1) % 3) = v(i);
      return out;
    };
    Motion<double, R> here, there;
    ASSERT_EQ(motion_from_task(geometry, task.z, task.zd, task.zdd, here), Status::ok);
    Drives q_there = turned(here.posture.q);
    if (R::kTelescope) q_there(R::kDrives - 1) += 2.0943951023931953;
    ASSERT_EQ(motion_from_drives<double>(geometry, q_there, turned(here.qd), turned(here.qdd), there), Status::ok);
    const Drives tau = inverse_dynamics<Layout>(geometry, here, p);
    EXPECT_THAT(inverse_dynamics<Layout>(geometry, there, p),
                IsNear(turned(tau), 1e-11 * (1 + tau.cwiseAbs().maxCoeff())));
  }
}

}  // namespace
}  // namespace deltadyn
