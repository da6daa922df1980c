#include "deltadyn/signal/differentiate.hpp"

#include <gtest/gtest.h>

#include "deltadyn/runtime/error.hpp"

#include "signal/multi_sine.hpp"

namespace deltadyn {
namespace {

using namespace deltadyn::testing_support;

Eigen::VectorXd power_derivative(const Eigen::VectorXd& t, int power, int derivative) {
  double factor = 1;
  for (int j = 0; j < derivative; ++j) factor *= power - j;
  if (factor == 0.0) return Eigen::VectorXd::Zero(t.size());
  return factor * t.array().pow(power - derivative);
}

TEST(Differentiate, IsExactForPolynomialsUpToTheEnds) {
  const Eigen::VectorXd t = times(100, 60).array() - 0.2;
  for (int half_width = 1; half_width <= 4; ++half_width) {
    for (int power = 0; power <= 2 * half_width; ++power) {
      for (int derivative = 1; derivative <= 2; ++derivative) {
        const Eigen::VectorXd x = t.array().pow(power);
        const Eigen::VectorXd got = differentiate(x, 0.01, derivative, half_width);
        EXPECT_LT((got - power_derivative(t, power, derivative)).cwiseAbs().maxCoeff(), 1e-8)
            << "half width " << half_width << ", power " << power << ", derivative " << derivative;
      }
    }
  }
}

TEST(Differentiate, HasTheKnownCentralWeights) {
  const Eigen::VectorXd first = derivative_weights(5, 4, 1, 2.0);
  const Eigen::VectorXd second = derivative_weights(5, 4, 2, 2.0);
  EXPECT_LT((first - (Eigen::VectorXd(5) << 1, -8, 0, 8, -1).finished() / 12.0).norm(), 1e-13);
  EXPECT_LT((second - (Eigen::VectorXd(5) << -1, 16, -30, 16, -1).finished() / 12.0).norm(), 1e-13);
}

TEST(SavitzkyGolay, HasTheWeightsOfTheOriginalTables) {
  // Savitzky and Golay 1964: quadratic smoothing of five and first derivative of seven points.
  EXPECT_LT((derivative_weights(5, 2, 0, 2.0) - (Eigen::VectorXd(5) << -3, 12, 17, 12, -3).finished() / 35.0).norm(),
            1e-13);
  EXPECT_LT(
      (derivative_weights(7, 2, 1, 3.0) - (Eigen::VectorXd(7) << -3, -2, -1, 0, 1, 2, 3).finished() / 28.0).norm(),
      1e-13);
}

TEST(SavitzkyGolay, IsExactForItsDegreeAndSmoothsNoise) {
  const Eigen::VectorXd t = times(1000, 400);
  for (int power = 0; power <= 3; ++power) {
    const Eigen::VectorXd x = t.array().pow(power);
    for (int derivative = 0; derivative <= 2; ++derivative) {
      const Eigen::VectorXd got = savitzky_golay(x, 0.001, derivative, 12, 3);
      EXPECT_LT((got - power_derivative(t, power, derivative)).cwiseAbs().maxCoeff(), 1e-7);
    }
  }
  const MultiSine motion;
  const Eigen::VectorXd s = times(1000, 4000);
  const Eigen::VectorXd q = quantised(motion.at(s, 0), 19);
  const Eigen::VectorXd truth = motion.at(s, 2);
  const double smoothed = rms(Eigen::VectorXd(savitzky_golay(q, 0.001, 2, 25, 4)) - truth);
  const double raw = rms(Eigen::VectorXd(differentiate(q, 0.001, 2, 2)) - truth);
  EXPECT_LT(smoothed, raw / 100.0);
}

TEST(Differentiate, RefusesTooFewSamples) {
  EXPECT_THROW((void)differentiate(Eigen::MatrixXd::Zero(6, 1), 0.001, 1, 3), Error);
  EXPECT_THROW((void)differentiate(Eigen::MatrixXd::Zero(60, 1), 0.0, 1, 3), Error);
  EXPECT_THROW((void)differentiate(Eigen::MatrixXd::Zero(60, 1), 0.001, 3, 3), Error);
  EXPECT_THROW((void)derivative_weights(5, 5, 1, 2.0), Error);
}

}  // namespace
}  // namespace deltadyn
