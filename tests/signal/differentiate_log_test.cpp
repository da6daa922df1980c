#include "deltadyn/signal/differentiate_log.hpp"

#include <gtest/gtest.h>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/signal/reversal_mask.hpp"

#include "signal/multi_sine.hpp"

namespace deltadyn {
namespace {

using namespace deltadyn::testing_support;

Log encoder_log(const MultiSine& motion, int bits) {
  Log log;
  log.file = "log.csv";
  log.t_s = times(1000, 10000);
  log.q = quantised(motion.at(log.t_s, 0), bits);
  return log;
}

TEST(DifferentiateLog, MeetsTheTruthBehindANineteenBitEncoder) {
  const MultiSine motion;
  const Log log = encoder_log(motion, 19);
  const DriveMotion got = differentiate_log(log, 25.0);
  const Eigen::Index count = got.last - got.first;
  EXPECT_GT(count, 9800);
  const auto error = [&](const Eigen::MatrixXd& x, int derivative) {
    return rms(Eigen::VectorXd((x.col(0) - motion.at(log.t_s, derivative)).segment(got.first, count)));
  };
  // Highest frequency 2.5 Hz; the truth has an RMS of 0.26 rad, 1.5 rad/s and 13 rad/s^2.
  EXPECT_LT(error(got.q, 0), 2e-6);
  EXPECT_LT(error(got.qd, 1), 2e-4);
  EXPECT_LT(error(got.qdd, 2), 2e-2);
  // And it is the noise of the encoder that remains.
  const double noise = position_noise(log.q.col(0));
  EXPECT_LT(error(got.qd, 1), 1.5 * derivative_noise(noise, 1000, 25.0, 4, 1));
  EXPECT_LT(error(got.qdd, 2), 1.5 * derivative_noise(noise, 1000, 25.0, 4, 2));
}

TEST(DifferentiateLog, HasNoLag) {
  const MultiSine motion;
  const Log log = encoder_log(motion, 19);
  const DriveMotion got = differentiate_log(log, 25.0);
  const Eigen::VectorXd error = (got.qd.col(0) - motion.at(log.t_s, 1)).segment(got.first, got.last - got.first);
  // A lag dt shows as -dt times the acceleration.
  const Eigen::VectorXd slope = motion.at(log.t_s, 2).segment(got.first, got.last - got.first);
  EXPECT_LT(std::abs(error.dot(slope) / slope.squaredNorm()), 2e-7);
}

TEST(DifferentiateLog, RefusesALogShorterThanTheFilter) {
  Log log = encoder_log(MultiSine{}, 19);
  log.t_s = Eigen::VectorXd(log.t_s.head(100));
  log.q = Eigen::MatrixXd(log.q.topRows(100));
  EXPECT_THROW((void)differentiate_log(log, 10.0), Error);
  EXPECT_NO_THROW((void)differentiate_log(log, 100.0));
}

}  // namespace
}  // namespace deltadyn
