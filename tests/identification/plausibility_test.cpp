#include "../../src/identification/gate/plausibility.hpp"

#include <gtest/gtest.h>

#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

/// A log in which the tool turns from -`yaw` to `yaw` in the middle of the workspace.
Log turning_log(const Robot& robot, double yaw) {
  constexpr int kSamples = 50;
  Log log;
  log.file = "turn.csv";
  log.t_s.setLinSpaced(kSamples, 0, 1);
  log.q.resize(kSamples, robot.drives());
  Eigen::VectorXd q(robot.drives());
  for (int k = 0; k < kSamples; ++k) {
    const Eigen::Vector4d z(0, 0, -0.7, yaw * (2.0 * k / (kSamples - 1) - 1));
    EXPECT_EQ(robot.inverse_kinematics(z, q), Status::ok);
    log.q.row(k) = q.transpose();
  }
  return log;
}

TEST(PlateFindings, TellAPlateThatTurnsFartherThanItsPartsLetIt) {
  const auto robot = make_robot(four_limb_description("par4"));
  const double range = robot->description().plate_yaw_range();
  EXPECT_TRUE(gate::plate_findings(*robot, {turning_log(*robot, range)}).empty());
  const auto findings = gate::plate_findings(*robot, {turning_log(*robot, range), turning_log(*robot, 1.2 * range)});
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].key, "plate_range");
  EXPECT_EQ(findings[0].level, FindingLevel::warning);
  EXPECT_NEAR(findings[0].value, 1.2 * range, 1e-6);
}

TEST(PlateFindings, HaveNothingToSayOfADelta) {
  const auto robot = make_robot(delta_description("delta3"));
  Log log;
  log.q = Eigen::MatrixXd::Zero(5, 3);
  EXPECT_TRUE(gate::plate_findings(*robot, {log}).empty());
}

}  // namespace
}  // namespace deltadyn
