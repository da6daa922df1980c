#include "deltadyn/kinematics/jacobian_rates.hpp"

#include <gtest/gtest.h>

#include "support/drawn_motion.hpp"
#include "support/matchers.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

template <class R>
class JacobianRatesOf : public ::testing::Test {
 protected:
  static constexpr int N = R::kDrives;
  using Number = Dual<double, N>;

  /// d/dt of a Jacobian: its slopes by q, along qd.
  template <class Derived>
  Matrix<double, Derived::RowsAtCompileTime, N> along(const Eigen::MatrixBase<Derived>& J) const {
    Matrix<double, Derived::RowsAtCompileTime, N> rate;
    for (Eigen::Index i = 0; i < J.rows(); ++i) {
      for (int j = 0; j < N; ++j) rate(i, j) = J(i, j).slope.dot(drawn.motion.qd);
    }
    return rate;
  }

  DrawnMotion<R> drawn{81};
};
TYPED_TEST_SUITE(JacobianRatesOf, AllRobots);

TYPED_TEST(JacobianRatesOf, AreTheSlopesOfTheJacobians) {
  using R = TypeParam;
  auto& d = this->drawn;
  for (int state = 0; state < 100; ++state) {
    d.next();
    const JacobianRates<double, R> rates = jacobian_rates(d.geometry, d.motion);
    Posture<typename TestFixture::Number, R> nearby;
    const auto with_slopes = cast_geometry<typename TestFixture::Number>(d.geometry);
    ASSERT_EQ(posture_with_slopes(with_slopes, d.motion.posture, nearby), Status::ok);
    const double size = 1e-11 * (1 + d.motion.qd.norm());
    if constexpr (kHasPlate<R>) {
      EXPECT_THAT(rates.J_plate, IsNear(this->along(nearby.J_plate), size)) << "state " << state;
      for (int i = 0; i < R::kLimbs; ++i) {
        EXPECT_THAT(rates.limbs[i].J_beta, IsNear(this->along(nearby.limbs[i].J_beta), size));
        EXPECT_THAT(rates.limbs[i].J_gamma, IsNear(this->along(nearby.limbs[i].J_gamma), size));
      }
    }
    if constexpr (R::kTelescope) {
      EXPECT_THAT(rates.J_length, IsNear(this->along(nearby.telescope.J_length), size));
      EXPECT_THAT(rates.J_a, IsNear(this->along(nearby.telescope.J_a), size));
      EXPECT_THAT(rates.J_b, IsNear(this->along(nearby.telescope.J_b), size));
    }
  }
}

// zdd = J qdd + Jdot qd.
TYPED_TEST(JacobianRatesOf, CompleteTheAccelerationOfThePlate) {
  auto& d = this->drawn;
  for (int state = 0; state < 100; ++state) {
    d.next();
    const auto& m = d.motion;
    const auto J_d = task_jacobian_rate(jacobian_rates(d.geometry, m));
    const typename DrawnMotion<TypeParam>::Drives zdd = task_jacobian(m.posture) * m.qdd + J_d * m.qd;
    EXPECT_THAT(zdd, IsNear(m.zdd, 1e-12 * (1 + m.zdd.norm() + m.qd.squaredNorm()))) << "state " << state;
  }
}

TYPED_TEST(JacobianRatesOf, AreZeroAtRest) {
  using Drives = typename DrawnMotion<TypeParam>::Drives;
  auto& d = this->drawn;
  d.next();
  set_drive_rates<double, TypeParam>(d.geometry, Drives::Zero(), d.motion.qdd, d.motion);
  const auto rates = jacobian_rates(d.geometry, d.motion);
  EXPECT_EQ(task_jacobian_rate(rates).norm(), 0);
  for (const auto& limb : rates.limbs) EXPECT_EQ(limb.J_beta.norm() + limb.J_gamma.norm(), 0);
}

}  // namespace
}  // namespace deltadyn
