#include "deltadyn/runtime/reach.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

RobotDescription delta3() {
  RobotDescription robot;
  robot.type = "delta3";
  for (int i = 0; i < 3; ++i) {
    LimbGeometry<double> limb;
    limb.azimuth = 2.0943951023931953 * i;
    const Vector3<double> radial(std::cos(limb.azimuth), std::sin(limb.azimuth), 0);
    limb.p_WD = 0.2 * radial;
    limb.p_DE_0.x() = 0.525;
    limb.strut = 1.106;
    limb.p_BA = 0.05 * radial;
    robot.limbs.push_back(limb);
    DriveLimits limits;
    limits.lower = -0.9;
    limits.upper = 1.4;
    robot.limits.push_back(limits);
  }
  robot.parts.emplace_back();
  return robot;
}

TEST(Reach, EveryCellIsAllowedAndTheLowestPoseIsTheDrivesLimit) {
  const auto robot = make_robot(delta3());
  const Reach reach = find_reach(*robot);
  ASSERT_GT(reach.points.rows(), 1000);
  Eigen::VectorXd q(3);
  for (Eigen::Index k = 0; k < reach.points.rows(); k += 37) {
    ASSERT_EQ(robot->inverse_kinematics(reach.points.row(k).transpose(), q), Status::ok);
    EXPECT_GE(q.minCoeff(), -0.9);
    EXPECT_LE(q.maxCoeff(), 1.4);
  }
  // Straight below the base all arms stand at the upper limit: a triangle of arm and strut, by hand.
  const double across = 0.2 + 0.525 * std::cos(1.4) - 0.05;
  const double lowest = -0.525 * std::sin(1.4) - std::sqrt(1.106 * 1.106 - across * across);
  EXPECT_NEAR(reach.lower.z(), lowest, 1.5 * reach.cell);
  EXPECT_LT(reach.upper.z(), 0);
  EXPECT_NEAR(reach.volume, static_cast<double>(reach.points.rows()) * std::pow(reach.cell, 3), 1e-9);
  EXPECT_LE(1.0, reach.condition_best);
  EXPECT_LE(reach.condition_best, reach.condition_median);
  EXPECT_LE(reach.condition_median, reach.condition_worst_of_95);
  EXPECT_LE(reach.condition.maxCoeff(), 50);
}

TEST(Reach, AFinerGridAgrees) {
  const auto robot = make_robot(delta3());
  const Reach coarse = find_reach(*robot), better = find_reach(*robot, 101);
  EXPECT_NEAR(coarse.volume, better.volume, 0.03 * better.volume);
  EXPECT_NEAR(coarse.radius, better.radius, 1.5 * coarse.cell);
}

TEST(Reach, SaysWhyThereIsNone) {
  RobotDescription axis;
  axis.type = "axis";
  axis.limbs.emplace_back();
  axis.limits.resize(1);
  EXPECT_THROW((void)find_reach(*make_robot(axis)), Error);
}

}  // namespace
}  // namespace deltadyn
