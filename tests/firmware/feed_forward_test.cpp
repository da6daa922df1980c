#include "deltadyn/firmware/feed_forward.hpp"

#include <gtest/gtest.h>
#include <limits>

#include "support/matchers.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

template <class R>
class FeedForwardOf : public ::testing::Test {
 protected:
  using DriveVector = Vector<double, R::kDrives>;
  using Control = FeedForward<double, R, Limbs::individual>;

  FeedForwardOf()
      : geometry(random_geometry<R>(random)),
        task(random_task<R>(random)),
        p(random_parameters<typename Control::Layout>(random)),
        control(geometry, p) {}

  Random random{30};
  Geometry<double, R> geometry;
  RandomTask<R> task;
  typename Control::Parameters p;
  Control control;
};
using Robots = ::testing::Types<Delta3, LinearDelta3, Delta4, Axis>;
TYPED_TEST_SUITE(FeedForwardOf, Robots);

TYPED_TEST(FeedForwardOf, GivesInverseDynamicsOfTheSetPoint) {
  typename TestFixture::DriveVector q, qd, tau, tau_of_drives;
  ASSERT_EQ(this->control.from_task(this->task.z, this->task.zd, this->task.zdd, q, qd, tau), Status::ok);
  Motion<double, TypeParam> motion;
  ASSERT_EQ(motion_from_task(this->geometry, this->task.z, this->task.zd, this->task.zdd, motion), Status::ok);
  EXPECT_EQ(q, motion.posture.q);
  EXPECT_EQ(qd, motion.qd);
  EXPECT_EQ(tau, (inverse_dynamics<typename TestFixture::Control::Layout>(this->geometry, motion, this->p)));
  ASSERT_EQ(this->control.from_drives(q, qd, motion.qdd, tau_of_drives), Status::ok);
  EXPECT_THAT(tau_of_drives, IsNear(tau, 1e-10 * (1 + tau.norm())));
}

TYPED_TEST(FeedForwardOf, KeepsTheLastGoodValuesOnFailure) {
  using V = typename TestFixture::DriveVector;
  const V old = V::Constant(42);
  V q = old, qd = old, tau = old, z = this->task.z;
  z(0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(this->control.from_task(z, this->task.zd, this->task.zdd, q, qd, tau), Status::out_of_range);
  EXPECT_EQ(this->control.from_drives(z, this->task.zd, this->task.zdd, tau), Status::out_of_range);
  if (kHasPlate<TypeParam>) {
    z(0) = 10;
    EXPECT_EQ(this->control.from_task(z, this->task.zd, this->task.zdd, q, qd, tau), Status::unreachable);
  }
  EXPECT_EQ(q, old);
  EXPECT_EQ(qd, old);
  EXPECT_EQ(tau, old);
}

// A set point generator that divides by zero must not reach the drives.
TYPED_TEST(FeedForwardOf, RefusesRatesThatAreNotFinite) {
  using V = typename TestFixture::DriveVector;
  const V old = V::Constant(42);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    V q = old, qd = old, tau = old;
    V rates = this->task.zd;
    rates(0) = bad;
    EXPECT_EQ(this->control.from_task(this->task.z, rates, this->task.zdd, q, qd, tau), Status::out_of_range);
    EXPECT_EQ(this->control.from_task(this->task.z, this->task.zd, rates, q, qd, tau), Status::out_of_range);
    V drives;
    ASSERT_EQ(inverse_kinematics(this->geometry, this->task.z, drives), Status::ok);
    EXPECT_EQ(this->control.from_drives(drives, rates, this->task.zdd, tau), Status::out_of_range);
    EXPECT_EQ(this->control.from_drives(drives, this->task.zd, rates, tau), Status::out_of_range);
    EXPECT_EQ(tau, old);
    EXPECT_EQ(q, old);
  }
}

}  // namespace
}  // namespace deltadyn
