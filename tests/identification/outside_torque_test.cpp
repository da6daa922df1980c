// Rows in which something else than the drive moves the machine (src/identification/gate/outside_torque.hpp), through
// the gate.

#include <cmath>
#include <gtest/gtest.h>

#include "deltadyn/identification/log_gate.hpp"

#include "identification/axis_log.hpp"
#include "identification/synthetic_log.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

/// A hand moves the machine away and back: the encoder shows it, the drive gives no torque for it.
void push(Log& log, double at_s, double distance) {
  log.q.array() += distance * (-((log.t_s.array() - at_s) / 0.12).square()).exp();
}

std::vector<LogFinding> pushes(const Robot& robot, const std::vector<Log>& logs, std::vector<Log>* mended = nullptr) {
  GateResult result = examine_logs(robot, logs, {}, {});
  if (mended != nullptr) *mended = result.logs;
  std::erase_if(result.findings, [](const LogFinding& f) { return f.key != "outside_torque"; });
  return result.findings;
}

AxisLog drive_log(std::uint64_t seed) {
  AxisLog log;
  log.encoder_bits = 11;
  log.rate_hz = 300;
  log.duration_s = 20;
  log.amplitude = 0.3;
  log.seed = seed;
  return log;
}

TEST(OutsideTorque, IsLeftOutAndSaid) {
  const auto robot = make_robot(axis_description(DriveKind::revolute));
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    Log log = drive_log(seed).make();
    push(log, 7.0, 0.6);
    push(log, 13.0, 0.07);  // too weak to be certain by itself
    std::vector<Log> mended;
    const std::vector<LogFinding> found = pushes(*robot, {log}, &mended);
    ASSERT_EQ(found.size(), 1U) << seed;
    EXPECT_EQ(found[0].level, FindingLevel::mended);
    EXPECT_EQ(found[0].drive, 0);
    EXPECT_LT(found[0].value, 3) << found[0].text;
    const auto& out = mended[0].torque_out;
    ASSERT_GT(out.size(), 0);
    EXPECT_TRUE(out(static_cast<Eigen::Index>(7.0 * 300), 0)) << found[0].text;
    EXPECT_TRUE(out(static_cast<Eigen::Index>(13.0 * 300), 0)) << found[0].text;
    EXPECT_FALSE(out(static_cast<Eigen::Index>(10.0 * 300), 0)) << found[0].text;
  }
}

// What a model lacks is no push: friction that is twice as large at slow speeds, a bristle, noise, a coarse encoder.
TEST(OutsideTorque, IsNotWhatTheModelLacks) {
  const auto robot = make_robot(axis_description(DriveKind::revolute));
  for (const std::uint64_t seed : {4U, 5U, 6U}) {
    AxisLog how = drive_log(seed);
    how.presliding = seed == 5 ? 0.01 : 0;
    how.torque_noise = seed == 6 ? 1.5 : 0.05;
    Log log = how.make();
    const Eigen::VectorXd v =
        testing_support::MultiSine{how.base_hz, how.amplitude}.at(log.t_s, 1, 0.7 * static_cast<double>(seed));
    for (Eigen::Index k = 0; k < log.samples(); ++k)
      log.tau(k, 0) += (v(k) > 0 ? 2.0 : -2.0) * std::exp(-std::abs(v(k)) / 0.1);
    EXPECT_TRUE(pushes(*robot, {log}).empty()) << seed;
  }
}

TEST(OutsideTorque, ALogThatIsPushedMostOfTheTimeStaysAsItIs) {
  const auto robot = make_robot(axis_description(DriveKind::revolute));
  Log log = drive_log(7).make();
  for (double at_s = 1; at_s < 19; at_s += 0.8) push(log, at_s, 0.5);
  EXPECT_TRUE(pushes(*robot, {log}).empty());
}

// The torque of a servo that is off is left out already.
TEST(OutsideTorque, IsNotATorqueThatIsMissing) {
  const auto robot = make_robot(axis_description(DriveKind::revolute));
  for (const std::uint64_t seed : {8U, 9U, 10U}) {
    Log log = drive_log(seed).make();
    // Off where the machine would need most: more is missing there than the drive gives in the rest of the log.
    Eigen::Index most = 0, half = 75;
    log.tau.col(0).segment(half, log.samples() - 2 * half).cwiseAbs().maxCoeff(&most);
    log.tau.middleRows(most, 2 * half + 1).setZero();
    log.torque_out.setConstant(log.samples(), 1, false);
    log.torque_out.middleRows(most, 2 * half + 1) = true;
    EXPECT_TRUE(pushes(*robot, {log}).empty()) << seed;
  }
}

TEST(OutsideTorque, OnAParallelRobotOnlyWhereItIs) {
  const auto robot = make_robot(delta_description("delta3"));
  SyntheticOptions synthetic;
  synthetic.torque_noise = 0.1;
  synthetic.encoder_step = 1.2e-5;
  synthetic.with_derivatives = false;
  synthetic.duration_s = 10;
  Log log = synthetic_log(*robot, delta_truth(*robot), synthetic);
  log.file = "sound";
  EXPECT_TRUE(pushes(*robot, {log}).empty());
}

}  // namespace
}  // namespace deltadyn
