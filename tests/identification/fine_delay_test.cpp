#include "deltadyn/identification/fine_delay.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "deltadyn/effects/bristle.hpp"
#include "deltadyn/identification/identify.hpp"
#include "deltadyn/signal/torque_timing_mend.hpp"

#include "identification/synthetic_log.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

constexpr double kDisplacement = 2e-3;

Eigen::Index column(const Robot& robot, const std::string& name) {
  const auto& names = robot.parameter_names();
  return std::find(names.begin(), names.end(), name) - names.begin();
}

/// A delta3 with a bristle in every drive, its torque late by `delay_s`.
Log bristly_log(const Robot& robot, const Eigen::VectorXd& truth, std::uint64_t seed, double damping_s, double delay_s,
                int only_drive = -1) {
  SyntheticOptions options;
  options.duration_s = 10;
  options.rate_hz = 500;
  options.base_frequency_hz = 0.2;
  options.torque_noise = 0.05;
  options.encoder_step = 5e-6;
  options.seed = seed;
  Log log = synthetic_log(robot, truth, options);
  for (Eigen::Index j = 0; j < log.drives(); ++j) {
    const double coulomb = truth(column(robot, "drive" + std::to_string(j + 1) + ".coulomb"));
    Bristle<double> bristle(kDisplacement, log.qd(0, j) > 0 ? 1.0 : -1.0);
    for (Eigen::Index k = 0; k < log.samples(); ++k) {
      const double rate = log.qd(k, j), state = bristle.move(k > 0 ? log.q(k, j) - log.q(k - 1, j) : 0.0);
      log.tau(k, j) += coulomb * (damped_bristle(rate, state, kDisplacement, damping_s) - (rate > 0 ? 1.0 : -1.0));
    }
    if (only_drive < 0 || only_drive == j)
      log.tau.col(j) = mend_timing(log.tau.col(j), log.sample_time_s(), -delay_s, 0.0);
  }
  log.qd.resize(0, 0);
  log.qdd.resize(0, 0);
  return log;
}

class FineDelayOf : public ::testing::TestWithParam<std::pair<double, double>> {  // damping, delay
 protected:
  std::unique_ptr<Robot> robot_ = make_robot(delta_description("delta3"));
  Eigen::VectorXd truth_ = delta_truth(*robot_);

  [[nodiscard]] std::vector<Log> logs(std::uint64_t seed, int only_drive = -1) const {
    const auto [damping_s, delay_s] = GetParam();
    return {bristly_log(*robot_, truth_, seed, damping_s, delay_s, only_drive),
            bristly_log(*robot_, truth_, seed + 1, damping_s, delay_s, only_drive)};
  }
};

TEST_P(FineDelayOf, AMachineWithBristlesIsFound) {
  const double delay_s = GetParam().second;
  const std::vector<Log> recorded = logs(101);
  const Identification result = identify(*robot_, recorded, truth_, {}, {});
  const FineDelay found = find_fine_delay(*robot_, result.base, recorded, result.processing);
  EXPECT_NEAR(found.delay_s, delay_s, 4 * found.std_s);
  EXPECT_LT(found.std_s, 1e-4);
  EXPECT_EQ(found.certain, delay_s != 0);

  // A finished model tells it of a log of its own.
  const FineDelay known = find_fine_delay(
      *robot_, result.base, {bristly_log(*robot_, truth_, 111, GetParam().first, delay_s)},
      [&] {
        ProcessingOptions exact = result.processing;
        exact.presliding.setConstant(3, kDisplacement);
        exact.presliding_damping_s.setConstant(3, GetParam().first);
        return exact;
      }(),
      &truth_);
  EXPECT_NEAR(known.delay_s, delay_s, std::max(4 * known.std_s, 3e-5));
  EXPECT_EQ(known.certain, delay_s != 0);
}

INSTANTIATE_TEST_SUITE_P(Delays, FineDelayOf,
                         ::testing::Values(std::pair(0.0, 0.0), std::pair(2e-3, 0.0), std::pair(0.0, 5e-4),
                                           std::pair(2e-3, -5e-4), std::pair(2e-3, 8e-4)));

TEST(FineDelay, OfOneDriveAloneIsNoRecordersDelay) {
  const auto robot = make_robot(delta_description("delta3"));
  const Eigen::VectorXd truth = delta_truth(*robot);
  const std::vector<Log> logs = {bristly_log(*robot, truth, 121, 2e-3, 1.5e-3, 1),
                                 bristly_log(*robot, truth, 122, 2e-3, 1.5e-3, 1)};
  const Identification result = identify(*robot, logs, truth, {}, {});
  EXPECT_FALSE(find_fine_delay(*robot, result.base, logs, result.processing).certain);
}

TEST(FineDelay, IsNotLookedForWithoutBristles) {
  const auto robot = make_robot(delta_description("delta3"));
  SyntheticOptions options;
  options.with_derivatives = false;
  const std::vector<Log> logs = {synthetic_log(*robot, delta_truth(*robot), options)};
  EXPECT_FALSE(find_fine_delay(*robot, find_base_parameters(*robot), logs, {}).certain);
}

TEST(WithoutDelay, MovesTheTorqueAndMarksWhatIsMissing) {
  Log log;
  const Eigen::Index N = 400;
  log.t_s = Eigen::VectorXd::LinSpaced(N, 0, 0.002 * (N - 1));
  log.q = log.tau = (2 * log.t_s).array().sin().matrix();
  const Log moved = without_delay({log}, 5e-4).front();
  EXPECT_NEAR(moved.tau(200, 0), std::sin(2 * (log.t_s(200) + 5e-4)), 1e-6);
  EXPECT_TRUE(moved.is_left_out(N - 1));
  EXPECT_FALSE(moved.is_left_out(N - 2));
  EXPECT_TRUE(without_delay({log}, -5e-4).front().is_left_out(0));
}

}  // namespace
}  // namespace deltadyn
