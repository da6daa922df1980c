#include "deltadyn/dynamics/inverse_dynamics_derivatives.hpp"

#include <gtest/gtest.h>

#include "support/drawn_motion.hpp"
#include "support/matchers.hpp"
#include "support/posture_at.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

template <class R>
class Derivatives : public ::testing::Test {
 protected:
  DrawnMotion<R> drawn{71};
};
TYPED_TEST_SUITE(Derivatives, AllRobots);

TYPED_TEST(Derivatives, AreTheSlopesOfTheTorque) {
  using R = TypeParam;
  constexpr int N = R::kDrives;
  using Layout = typename DrawnMotion<R>::Layout;
  using Drives = typename DrawnMotion<R>::Drives;
  using Square = typename DrawnMotion<R>::Square;
  auto& d = this->drawn;
  for (int state = 0; state < 200; ++state) {
    d.next();
    TorqueDerivatives<double, N> found;
    ASSERT_EQ((inverse_dynamics_derivatives<Layout>(d.geometry, d.motion, d.p, found)), Status::ok);
    const Drives q = d.motion.posture.q, qd = d.motion.qd, qdd = d.motion.qdd;
    const auto torque = [&](const Drives& place, const Drives& rate, const Drives& acceleration) {
      Motion<double, R> motion;
      EXPECT_EQ(posture_at(d.geometry, place, d.task.z, motion.posture), Status::ok);
      set_drive_rates<double, R>(d.geometry, rate, acceleration, motion);
      return Drives(inverse_dynamics<Layout>(d.geometry, motion, d.p));
    };
    Square by_q, by_qd, by_qdd;
    const double h = 1e-3;  // the differences are of fourth order; by qd and qdd they are exact but for rounding
    for (int j = 0; j < N; ++j) {
      const Drives e = Drives::Unit(j);
      const auto slope = [&](auto&& at) -> Drives {
        return (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
      };
      by_q.col(j) = slope([&](double s) { return torque(q + s * e, qd, qdd); });
      by_qd.col(j) = slope([&](double s) { return torque(q, qd + s * e, qdd); });
      by_qdd.col(j) = slope([&](double s) { return torque(q, qd, qdd + s * e); });
    }
    // A difference that steps over a reversal of the inner joint says nothing about the slope.
    if constexpr (kHasInnerJoint<R>) {
      if (std::abs(inner_joint(d.motion).rate) < (R::kTelescope ? 0.01 : 0.1)) continue;
    }
    EXPECT_THAT(found.by_q, IsNear(by_q, 1e-7 * (1 + by_q.norm()))) << "state " << state;
    if ((qd.cwiseAbs().array() > 2 * h).all()) {
      EXPECT_THAT(found.by_qd, IsNear(by_qd, 1e-8 * (1 + by_qd.norm())));
    }
    EXPECT_THAT(found.by_qdd, IsNear(by_qdd, 1e-8 * (1 + by_qdd.norm())));
  }
}

// Two ways to the same slopes: 2C plus viscous friction, and dual numbers with qd in the place of q.
TYPED_TEST(Derivatives, ByTheRatesAreThoseOfDualNumbers) {
  using R = TypeParam;
  constexpr int N = R::kDrives;
  using Layout = typename DrawnMotion<R>::Layout;
  using Number = Dual<double, N>;
  auto& d = this->drawn;
  for (int state = 0; state < 200; ++state) {
    d.next();
    TorqueDerivatives<double, N> found;
    ASSERT_EQ((inverse_dynamics_derivatives<Layout>(d.geometry, d.motion, d.p, found)), Status::ok);
    const auto geometry = cast_geometry<Number>(d.geometry);
    Motion<Number, R> motion;
    Vector<Number, N> qd = d.motion.qd.template cast<Number>();
    for (int i = 0; i < N; ++i) qd(i).slope = Vector<double, N>::Unit(i);
    ASSERT_EQ((assemble_posture<Number, R>(geometry, d.motion.posture.q.template cast<Number>(),
                                           d.motion.posture.z.template cast<Number>(), motion.posture)),
              Status::ok);
    set_drive_rates<Number, R>(geometry, qd, d.motion.qdd.template cast<Number>(), motion);
    const Vector<Number, N> tau = inverse_dynamics<Layout, Number, R>(geometry, motion, d.p.template cast<Number>());
    Matrix<double, N, N> expected;
    for (int i = 0; i < N; ++i) expected.row(i) = tau(i).slope.transpose();
    EXPECT_THAT(found.by_qd, IsNear(expected, 1e-10 * (1 + expected.norm()))) << "state " << state;
  }
}

}  // namespace
}  // namespace deltadyn
