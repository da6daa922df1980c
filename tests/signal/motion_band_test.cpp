#include "deltadyn/signal/motion_band.hpp"

#include <gtest/gtest.h>
#include <random>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/random.hpp"

#include "signal/multi_sine.hpp"

namespace deltadyn {
namespace {

using namespace deltadyn::testing_support;

constexpr double kRate = 1000;

/// One drive of inertia 1: five harmonics of `base_hz`, an encoder of `bits`, a torque with white noise.
Log drive_log(double base_hz, int bits, double torque_noise, double structure = 0) {
  std::mt19937_64 random(3);
  NormalDistribution normal;
  Log log;
  log.file = "drive";
  log.t_s = times(kRate, 10'000);
  const MultiSine motion{base_hz, 0.5};
  log.q = quantised(motion.at(log.t_s, 0), bits);
  log.tau = motion.at(log.t_s, 2) + structure * motion.at(log.t_s, 1).cwiseSign();
  for (Eigen::Index k = 0; k < log.samples(); ++k) log.tau(k, 0) += torque_noise * normal(random);
  return log;
}

TEST(MotionBand, SeesTheEncodersNoise) {
  for (const int bits : {13, 16, 19}) {
    const Log log = drive_log(0.5, bits, 0.1);
    const double step = 2 * std::numbers::pi / std::pow(2.0, bits);
    const double std = std::sqrt(motion_band(log.q.col(0), kRate).noise_density * kRate / 2);
    EXPECT_NEAR(std, step / std::sqrt(12.0), 0.2 * step / std::sqrt(12.0)) << bits;
  }
}

TEST(MotionBand, EndsWithTheMotion) {
  for (const double base_hz : {0.5, 1.0, 4.0}) {
    const double highest = 5 * base_hz;
    const MotionBand band = motion_band(drive_log(base_hz, 19, 0.1).q.col(0), kRate);
    EXPECT_GT(band.content_hz, 0.8 * highest);
    EXPECT_LT(band.content_hz, 2.5 * highest);
    EXPECT_GE(band.top_hz, band.content_hz);
  }
}

TEST(ChooseCutoff, FinerEncodersAllowMore) {
  double last = 0;
  for (const int bits : {11, 13, 16}) {
    const double limit = choose_cutoff({drive_log(4, bits, 0.1)}).noise_limit_hz;
    EXPECT_GT(limit, last) << bits;
    last = limit;
  }
}

// What a model lacks (here friction beside an inertia) must not turn the cut-off.
TEST(ChooseCutoff, DoesNotDependOnWhatAModelWouldLack) {
  const double plain = choose_cutoff({drive_log(1, 16, 0.1)}).cutoff_hz;
  EXPECT_NEAR(choose_cutoff({drive_log(1, 16, 0.1, 3.0)}).cutoff_hz, plain, 1e-9);
}

TEST(ChooseCutoff, ADriveAtRestAsksForNothing) {
  Log log = drive_log(4, 16, 0.1);
  const double alone = choose_cutoff({log}).cutoff_hz;
  log.q.conservativeResize(Eigen::NoChange, 2);
  log.tau.conservativeResize(Eigen::NoChange, 2);
  log.q.col(1).setConstant(0.3);
  log.tau.col(1).setConstant(2.0);
  EXPECT_NEAR(choose_cutoff({log}).cutoff_hz, alone, 1e-9);
}

TEST(ChooseCutoff, RefusesWhatShowsNoBand) {
  EXPECT_THROW((void)choose_cutoff({}), Error);
  Log log = drive_log(1, 16, 0.1);
  log.t_s *= 100;  // ten samples a second
  EXPECT_THROW((void)choose_cutoff({log}), Error);
}

}  // namespace
}  // namespace deltadyn
