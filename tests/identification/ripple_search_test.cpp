#include "../../src/identification/ripple_search.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "deltadyn/identification/identify.hpp"
#include "deltadyn/identification/prediction.hpp"

#include "identification/axis_log.hpp"
#include "identification/synthetic_log.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

ProcessingOptions at_20_hz() {
  ProcessingOptions processing;
  processing.cutoff_hz = 20;
  return processing;
}

/// A machine recorded twice, noise and phase of the motion by the seed.
std::vector<Log> two_slow_logs(AxisLog log, std::uint64_t seed) {
  log.base_hz = 0.11;
  std::vector<Log> logs;
  for (log.seed = seed; log.seed < seed + 2; ++log.seed) logs.push_back(log.make());
  return logs;
}

class RippleOfAnAxis : public ::testing::TestWithParam<double> {};

TEST_P(RippleOfAnAxis, IsFoundBelowTheNoise) {
  const auto robot = make_robot(axis_description(DriveKind::revolute));
  AxisLog log;
  log.ripple = 0.03;  // the noise of a sample is 0.05
  log.waves = GetParam();
  const std::vector<Log> logs = two_slow_logs(log, 31);
  const auto found = find_ripples(*robot, find_base_parameters(*robot), logs, at_20_hz());
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].n, GetParam(), std::max(4 * found[0].n_std, 0.01 * GetParam()));
  EXPECT_NEAR(std::hypot(found[0].cosine, found[0].sine), 0.03, 4 * found[0].amplitude_std);
  EXPECT_LT(found[0].amplitude_std, 0.005);
}

INSTANTIATE_TEST_SUITE_P(Waves, RippleOfAnAxis, ::testing::Values(31.0, 47.0, 84.0));

TEST(FindRipples, FindsNoneInCleanLogs) {
  const auto robot = make_robot(axis_description(DriveKind::revolute));
  for (std::uint64_t seed = 41; seed < 61; ++seed) {
    AxisLog log;
    log.base_hz = seed % 2 == 0 ? 0.37 : 0.11;
    log.seed = seed;
    EXPECT_TRUE(find_ripples(*robot, find_base_parameters(*robot), {log.make()}, at_20_hz()).empty()) << seed;
  }
}

// What else the model lacks can pass for a wave: beside it none is claimed, however well it fits.
TEST(FindRipples, ClaimsNoneBesideOtherStructure) {
  const auto robot = make_robot(axis_description(DriveKind::revolute));
  AxisLog log;
  log.ripple = 0.3;
  std::vector<Log> logs = two_slow_logs(log, 81);
  const BaseParameters base = find_base_parameters(*robot);
  EXPECT_EQ(find_ripples(*robot, base, logs, at_20_hz()).size(), 1U);
  for (Log& one : logs) one.tau.col(0).array() += 0.1 * (9 * one.t_s.array()).sin();
  EXPECT_TRUE(find_ripples(*robot, base, logs, at_20_hz()).empty());
}

// A ripple belongs to the place; what comes on the way there only, period after period, is something else.
TEST(FindRipples, ClaimsNoneThatComesOneWayOnly) {
  const auto robot = make_robot(axis_description(DriveKind::revolute));
  const std::vector<Log> logs = two_slow_logs({}, 91);
  const BaseParameters base = find_base_parameters(*robot);
  const auto with_wave = [&logs](bool both_ways) {
    std::vector<Log> out = logs;
    for (Log& log : out) {
      for (Eigen::Index k = 1; k < log.q.rows(); ++k)
        if (both_ways || log.q(k, 0) > log.q(k - 1, 0)) log.tau(k, 0) += 0.05 * std::sin(40 * log.q(k, 0));
    }
    return out;
  };
  EXPECT_EQ(find_ripples(*robot, base, with_wave(true), at_20_hz()).size(), 1U);
  EXPECT_TRUE(find_ripples(*robot, base, with_wave(false), at_20_hz()).empty());
}

/// Ripple of two drives on a whole robot; a third drive has none.
TEST(FindRipples, BelongsToTheModelOfARobot) {
  const auto robot = make_robot(delta_description("delta3"));
  const Eigen::VectorXd truth = delta_truth(*robot);
  const auto with_ripple = [&](std::uint64_t seed) {
    SyntheticOptions options;
    options.duration_s = 12;
    options.base_frequency_hz = 0.05;
    options.rate_hz = 500;
    options.torque_noise = 0.1;
    options.encoder_step = 5e-6;
    options.with_derivatives = false;
    options.seed = seed;
    Log log = synthetic_log(*robot, truth, options);
    log.tau.col(0).array() += 0.08 * (40 * log.q.col(0).array() + 1).cos();
    log.tau.col(2).array() += 0.06 * (64 * log.q.col(2).array() - 2).cos();
    return log;
  };
  const std::vector<Log> logs = {with_ripple(71), with_ripple(72)};
  ProcessingOptions processing = at_20_hz();
  const auto found = find_ripples(*robot, find_base_parameters(*robot), logs, processing);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].drive, 0);
  EXPECT_NEAR(found[0].n, 40, 0.4);
  EXPECT_NEAR(std::hypot(found[0].cosine, found[0].sine), 0.08, 4 * found[0].amplitude_std);
  EXPECT_EQ(found[1].drive, 2);
  EXPECT_NEAR(found[1].n, 64, 0.64);

  // With it the residual of another log is the torque's noise.
  const auto residual = [&](const ProcessingOptions& options) {
    const PreparedLog log = prepare_log(*robot, with_ripple(73), options);
    return predict(*robot, log, truth).rms_residual(0, false);
  };
  const double without = residual(processing);
  processing.ripples = found;
  EXPECT_LT(residual(processing), 0.75 * without);
}

}  // namespace
}  // namespace deltadyn
