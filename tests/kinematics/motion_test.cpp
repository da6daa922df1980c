#include "deltadyn/kinematics/motion.hpp"

#include <gtest/gtest.h>
#include <limits>

#include "support/core_instances.hpp"
#include "support/matchers.hpp"
#include "support/oracle_of.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

template <class R>
class MotionOf : public ::testing::Test {
 protected:
  void draw() {
    geometry = random_geometry<R>(random);
    task = random_task<R>(random);
    ASSERT_EQ(motion_from_task(geometry, task.z, task.zd, task.zdd, motion), Status::ok);
  }
  static double size(const Vector<double, R::kDrives>& v) { return 1 + v.norm(); }

  Random random{10};
  Geometry<double, R> geometry;
  RandomTask<R> task;
  Motion<double, R> motion;
};

using Robots = ::testing::Types<Delta3, LinearDelta3, Delta4, TurningPlate, Axis, LinearAxis>;
TYPED_TEST_SUITE(MotionOf, Robots);

// The drive rates that the library finds for zd and zdd, put through the loop equations, give zd and zdd again.
TYPED_TEST(MotionOf, TaskRatesAreThoseOfTheLoopEquations) {
  constexpr int P = kPlateCoordinates<TypeParam>;
  for (int trial = 0; trial < 100; ++trial) {
    this->draw();
    const auto y =
        oracles::plate(oracle_of(this->geometry), in_time(this->motion.posture.q, this->motion.qd, this->motion.qdd),
                       numbers(this->task.z));
    auto z = this->task.z, zd = this->task.zd, zdd = this->task.zdd;
    for (int k = 0; k < P; ++k) {
      const auto& coordinate = y[static_cast<std::size_t>(k)];
      z(k) = static_cast<double>(coordinate.value.value);
      zd(k) = static_cast<double>(coordinate.slope.value);
      zdd(k) = static_cast<double>(coordinate.slope.slope);
    }
    const double scale = this->size(this->motion.qdd);
    EXPECT_THAT(this->task.z, IsNear(z, 1e-13));
    EXPECT_THAT(this->task.zd, IsNear(zd, 1e-12 * scale));
    EXPECT_THAT(this->task.zdd, IsNear(zdd, 1e-12 * scale * scale));
    EXPECT_THAT(this->motion.zd, IsNear(this->task.zd, 1e-12 * scale));
    EXPECT_THAT(this->motion.zdd, IsNear(this->task.zdd, 1e-12 * scale * scale));
  }
}

TYPED_TEST(MotionOf, DriveRatesUndoTaskRates) {
  for (int trial = 0; trial < 100; ++trial) {
    this->draw();
    // Any numbers will do
    set_drive_rates<double, TypeParam>(this->geometry, this->task.zd, this->task.zdd, this->motion);
    auto qd = this->task.zd, qdd = this->task.zdd;
    ASSERT_EQ(drive_rates(this->geometry, this->motion.posture, this->motion.zd, this->motion.zdd, qd, qdd),
              Status::ok);
    EXPECT_THAT(qd, IsNear(this->task.zd, 1e-12 * this->size(this->task.zdd)));
    EXPECT_THAT(qdd, IsNear(this->task.zdd, 1e-11 * this->size(this->task.zdd)));
  }
}

/// The types with forward kinematics in closed form.
template <class R>
class MotionFromDrives : public MotionOf<R> {};
using ClosedForm = ::testing::Types<Delta3, LinearDelta3, Delta4, Axis, LinearAxis>;
TYPED_TEST_SUITE(MotionFromDrives, ClosedForm);

TYPED_TEST(MotionFromDrives, TaskAndDrivesLeadToTheSameMotion) {
  for (int trial = 0; trial < 100; ++trial) {
    this->draw();
    Motion<double, TypeParam> back;
    ASSERT_EQ(motion_from_drives(this->geometry, this->motion.posture.q, this->motion.qd, this->motion.qdd, back),
              Status::ok);
    const double scale = this->size(this->motion.qdd);
    EXPECT_THAT(back.posture.z, IsNear(this->task.z, 1e-13));
    EXPECT_THAT(back.zd, IsNear(this->task.zd, 1e-12 * scale));
    EXPECT_THAT(back.zdd, IsNear(this->task.zdd, 1e-11 * scale));
    for (int i = 0; i < TypeParam::kLimbs; ++i) {
      EXPECT_NEAR(back.limbs[i].beta_dd, this->motion.limbs[i].beta_dd, 1e-10 * scale);
      EXPECT_NEAR(back.limbs[i].gamma_dd, this->motion.limbs[i].gamma_dd, 1e-10 * scale);
    }
    EXPECT_NEAR(back.telescope.a_dd, this->motion.telescope.a_dd, 1e-10 * scale);
  }
}

using MotionOfDelta4 = MotionOf<Delta4>;
TEST_F(MotionOfDelta4, TelescopeLengthHasTheRatesOfTheLoopEquations) {
  for (int trial = 0; trial < 100; ++trial) {
    draw();
    const auto mechanism = oracle_of(geometry);
    const auto y = oracles::plate(mechanism, in_time(motion.posture.q, motion.qd, motion.qdd), numbers(task.z));
    const auto length = oracles::bar_length(mechanism, y);
    const double scale = size(motion.qdd);
    EXPECT_NEAR(motion.telescope.length_d, static_cast<double>(length.slope.value), 1e-12 * scale);
    EXPECT_NEAR(motion.telescope.length_dd, static_cast<double>(length.slope.slope), 1e-12 * scale * scale);
  }
}

TYPED_TEST(MotionOf, HandsOnWhyItFailed) {
  this->draw();
  auto z = this->task.z;
  z(0) = std::numeric_limits<double>::quiet_NaN();
  Motion<double, TypeParam> out;
  EXPECT_EQ(motion_from_task(this->geometry, z, this->task.zd, this->task.zdd, out), Status::out_of_range);
  if constexpr (kHasPlate<TypeParam>) {
    z(0) = 10;
    EXPECT_EQ(motion_from_task(this->geometry, z, this->task.zd, this->task.zdd, out), Status::unreachable);
  }
  if constexpr (!TypeParam::kPlateTurns) {
    z(0) = std::numeric_limits<double>::infinity();
    EXPECT_EQ(motion_from_drives(this->geometry, z, this->task.zd, this->task.zdd, out), Status::out_of_range);
  }
}

TYPED_TEST(MotionOf, RefusesRatesThatAreNotFinite) {
  this->draw();
  Motion<double, TypeParam> out;
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    auto rates = this->task.zd;
    rates(TypeParam::kDrives - 1) = bad;
    EXPECT_EQ(motion_from_task(this->geometry, this->task.z, rates, this->task.zdd, out), Status::out_of_range);
    EXPECT_EQ(motion_from_task(this->geometry, this->task.z, this->task.zd, rates, out), Status::out_of_range);
    if constexpr (!TypeParam::kPlateTurns) {
      EXPECT_EQ(motion_from_drives(this->geometry, this->motion.posture.q, rates, this->task.zdd, out),
                Status::out_of_range);
      EXPECT_EQ(motion_from_drives(this->geometry, this->motion.posture.q, this->task.zd, rates, out),
                Status::out_of_range);
    }
  }
}

TYPED_TEST(MotionOf, IsTheSameInSinglePrecision) {
  for (int trial = 0; trial < 50; ++trial) {
    this->draw();
    Motion<float, TypeParam> coarse;
    ASSERT_EQ(
        motion_from_task<float>(cast_geometry<float>(this->geometry), this->task.z.template cast<float>(),
                                this->task.zd.template cast<float>(), this->task.zdd.template cast<float>(), coarse),
        Status::ok);
    EXPECT_THAT(coarse.posture.q, IsNear(this->motion.posture.q, 1e-5));
    EXPECT_THAT(coarse.qd, IsNear(this->motion.qd, 1e-5 * this->size(this->motion.qd)));
    EXPECT_THAT(coarse.qdd, IsNear(this->motion.qdd, 1e-4 * this->size(this->motion.qdd)));
  }
}

}  // namespace
}  // namespace deltadyn
