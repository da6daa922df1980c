#include "deltadyn/signal/fourier.hpp"

#include <gtest/gtest.h>
#include <random>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/random.hpp"

#include "signal/multi_sine.hpp"

namespace deltadyn {
namespace {

using namespace deltadyn::testing_support;

/// Two drives with 19-bit encoders and noisy torque, `rate_hz` not necessarily a multiple of the base frequency.
Log periodic_log(const MultiSine& motion, double rate_hz, Eigen::Index samples, double torque_noise) {
  std::mt19937_64 random(17);
  NormalDistribution normal(0.0, torque_noise);
  Log log;
  log.file = "log.csv";
  log.t_s = times(rate_hz, samples);
  log.q.resize(samples, 2);
  log.tau.resize(samples, 2);
  for (int d = 0; d < 2; ++d) {
    log.q.col(d) = quantised(motion.at(log.t_s, 0, 0.7 * d), 19);
    log.tau.col(d) = 2.0 * motion.at(log.t_s, 2, 0.7 * d);
    for (Eigen::Index i = 0; i < samples; ++i) log.tau(i, d) += normal(random);
  }
  return log;
}

TEST(Fourier, EvaluatesExactDerivatives) {
  const MultiSine motion;
  const Eigen::VectorXd t = times(1000, 2000);
  const FourierFit fit = fit_fourier(t, motion.at(t, 0), motion.base_hz, 5);
  for (int derivative = 0; derivative <= 2; ++derivative) {
    EXPECT_LT((fit.evaluate(t, derivative).col(0) - motion.at(t, derivative)).cwiseAbs().maxCoeff(), 1e-10);
  }
  EXPECT_THROW((void)fit_fourier(t.head(10), motion.at(t, 0).head(10), 0.5, 5), Error);
}

TEST(FindPeriod, FindsWholeAndBrokenNumbersOfSamples) {
  for (const double base_hz : {0.5, 0.7, 1.0 / 1.3}) {
    const MultiSine motion{base_hz};
    const auto period = find_period(periodic_log(motion, 1000, 10000, 0.1));
    ASSERT_TRUE(period.has_value()) << base_hz;
    EXPECT_NEAR(period->period_s * base_hz, 1.0, 1e-6);
    EXPECT_EQ(period->whole_periods, static_cast<int>(std::floor(10.0 * base_hz + 1e-6)));
  }
}

TEST(FindPeriod, SaysNoToOnePeriodAndToDrift) {
  EXPECT_FALSE(find_period(periodic_log(MultiSine{0.1}, 1000, 10000, 0.1)).has_value());
  Log drifting = periodic_log(MultiSine{}, 1000, 10000, 0.1);
  drifting.q += 0.05 * drifting.t_s.replicate(1, 2);
  EXPECT_FALSE(find_period(drifting).has_value());
  Log still = periodic_log(MultiSine{}, 1000, 1000, 0.1);
  still.q.setConstant(0.3);
  EXPECT_FALSE(find_period(still).has_value());
}

TEST(AveragePeriods, MeetsTruthFarBelowTheEncoder) {
  for (const double base_hz : {0.5, 0.7}) {
    const MultiSine motion{base_hz};
    const Log log = periodic_log(motion, 1000, 10000, 0.1);
    const PeriodMean mean = average_periods(log, 1.0 / base_hz, 5);
    const Eigen::VectorXd& t = mean.log.t_s;
    EXPECT_EQ(mean.periods, static_cast<int>(10.0 * base_hz + 1e-6));
    for (int d = 0; d < 2; ++d) {
      EXPECT_LT(rms(mean.log.q.col(d) - motion.at(t, 0, 0.7 * d)), 5e-7);
      EXPECT_LT(rms(mean.log.qd.col(d) - motion.at(t, 1, 0.7 * d)), 5e-6);
      EXPECT_LT(rms(mean.log.qdd.col(d) - motion.at(t, 2, 0.7 * d)), 1e-4);
      // The scatter of the mean is the noise over the root of the number of periods.
      const double scatter = rms(mean.log.tau.col(d) - 2.0 * motion.at(t, 2, 0.7 * d));
      const double expected = 0.1 / std::sqrt(mean.periods);
      // Interpolation between samples smooths a little
      EXPECT_NEAR(scatter / expected, 1.0, base_hz == 0.5 ? 0.05 : 0.2);
    }
  }
}

TEST(AveragePeriods, LeavesOutWhatWasFilledIn) {
  Log log = periodic_log(MultiSine{}, 1000, 10000, 0.0);
  log.filled.assign(10000, 0);
  log.filled[2100] = 1;
  log.tau(2100, 0) = 1e6;
  const PeriodMean mean = average_periods(log, 2.0, 5);
  EXPECT_NEAR(mean.log.tau(100, 0), log.tau(100, 0), 1e-9);
  EXPECT_THROW((void)average_periods(log, 6.0, 5), Error);
}

}  // namespace
}  // namespace deltadyn
