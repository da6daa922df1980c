#include "deltadyn/trajectory/motion_limits.hpp"

#include <gmock/gmock.h>
#include <limits>

#include "deltadyn/runtime/error.hpp"

#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using ::testing::HasSubstr;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

MotionLimits limits_of(const RobotDescription& robot) {
  MotionLimits limits(robot);
  limits.qd.setConstant(6);
  limits.qdd.setConstant(60);
  limits.q_lower.setConstant(-0.9);
  limits.q_upper.setConstant(1.6);
  Region region;
  region.centre = {0, 0, -0.8};
  region.radius = 0.3;
  if (!robot.parts.empty()) limits.region = region;
  return limits;
}

std::string message_of(const MotionLimits& limits, const RobotDescription& robot) {
  try {
    limits.validate(robot);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::usage);
    return e.what();
  }
  return "no error";
}

TEST(MotionLimits, ListHoldsTheFiniteOnesWithNameAndUnit) {
  const RobotDescription robot = testing_support::delta_description("delta4");
  MotionLimits limits = limits_of(robot);
  limits.zdd(3) = 240;
  const auto list = limits.list(robot);
  ASSERT_EQ(list.size(), 1U + 1U + 4U * 3U);
  EXPECT_EQ(list[0].name, "workspace radius");
  const auto psi =
      std::find_if(list.begin(), list.end(), [](const Limit& l) { return l.quantity == LimitedQuantity::zdd; });
  EXPECT_EQ(psi->name, "psi acceleration");
  EXPECT_EQ(psi->unit, "rad/s^2");
  limits.parameters = Eigen::VectorXd::Ones(70);
  limits.tau(1) = 60;
  EXPECT_EQ(limits.list(robot).size(), list.size() + 1);
}

TEST(MotionLimits, UsageIsOneAtTheEndsAndItsSlopeFits) {
  const Limit both{LimitedQuantity::q, 0, -1, 3, "", ""}, upper{LimitedQuantity::q, 0, -kInfinity, 2, "", ""},
      lower{LimitedQuantity::q, 0, -2, kInfinity, "", ""}, wall{LimitedQuantity::region, 0, -kInfinity, 1, "", ""};
  EXPECT_DOUBLE_EQ(usage_of(both, 3), 1);
  EXPECT_DOUBLE_EQ(usage_of(both, -1), -1);
  EXPECT_DOUBLE_EQ(usage_of(upper, 2), 1);
  EXPECT_DOUBLE_EQ(usage_of(lower, -2), 1);
  EXPECT_DOUBLE_EQ(usage_of(wall, 0.7), 0.7);
  for (const Limit& limit : {both, upper, lower, wall})
    EXPECT_NEAR(usage_slope(limit), usage_of(limit, 1.5) - usage_of(limit, 0.5), 1e-15);
  EXPECT_DOUBLE_EQ(limit_load(both, -1.2), 1.2);
  EXPECT_DOUBLE_EQ(limit_load(wall, -1.2), -1.2);
}

TEST(MotionLimits, SlowedLimitsAreThoseOfTheSameMotionsInMoreTime) {
  const RobotDescription robot = testing_support::delta_description("delta3");
  const MotionLimits slow = limits_of(robot).slowed(0.5);
  EXPECT_DOUBLE_EQ(slow.qd(1), 3);
  EXPECT_DOUBLE_EQ(slow.qdd(1), 15);
  EXPECT_DOUBLE_EQ(slow.q_upper(1), 1.6);
}

TEST(MotionLimits, WhatExceedsTheRobotFileIsToldAndFarMoreIsRefused) {
  RobotDescription robot = testing_support::delta_description("delta4");
  for (DriveLimits& limits : robot.limits) limits.velocity = 6;
  MotionLimits limits = limits_of(robot);
  EXPECT_TRUE(limits.beyond_file(robot).empty());
  limits.qd(1) = 7;
  ASSERT_EQ(limits.beyond_file(robot).size(), 1U);
  EXPECT_THAT(limits.beyond_file(robot).front(),
              HasSubstr("drive 2: the velocity limit asked for, 7 rad/s, is beyond the 6 rad/s"));
  limits.qd(1) = 60;
  EXPECT_THROW((void)limits.beyond_file(robot), Error);
}

TEST(MotionLimits, NamesWhatContradicts) {
  const RobotDescription robot = testing_support::delta_description("delta4");
  EXPECT_EQ(message_of(limits_of(robot), robot), "no error");
  MotionLimits limits = limits_of(robot);
  limits.q_upper(2) = -1;
  EXPECT_THAT(message_of(limits, robot), HasSubstr("drive 3 position contradict each other"));
  limits = limits_of(robot);
  limits.qdd(0) = 0;
  EXPECT_THAT(message_of(limits, robot), HasSubstr("drive 1 acceleration limit is 0"));
  limits = limits_of(robot);
  limits.qd(3) = kInfinity;
  EXPECT_THAT(message_of(limits, robot), HasSubstr("neither psi nor drive 4 has a limit of its velocity"));
  limits = limits_of(robot);
  limits.z_upper(2) = -2;
  EXPECT_THAT(message_of(limits, robot), HasSubstr("nothing in common with the workspace"));
  limits = limits_of(robot);
  limits.zd.conservativeResize(3);
  EXPECT_THAT(message_of(limits, robot), HasSubstr("give 4"));
  const RobotDescription axis = testing_support::axis_description(DriveKind::revolute);
  EXPECT_EQ(message_of(limits_of(axis), axis), "no error");
}

}  // namespace
}  // namespace deltadyn
