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
  const Eigen::MatrixXd impulses = Eigen::MatrixXd::Identity(5, 5);
  const Eigen::VectorXd first = differentiate(impulses, 1.0, 1, 2).row(2);
  const Eigen::VectorXd second = differentiate(impulses, 1.0, 2, 2).row(2);
  EXPECT_LT((first - (Eigen::VectorXd(5) << 1, -8, 0, 8, -1).finished() / 12.0).norm(), 1e-13);
  EXPECT_LT((second - (Eigen::VectorXd(5) << -1, 16, -30, 16, -1).finished() / 12.0).norm(), 1e-13);
}

TEST(Differentiate, RefusesTooFewSamples) {
  EXPECT_THROW((void)differentiate(Eigen::MatrixXd::Zero(6, 1), 0.001, 1, 3), Error);
  EXPECT_THROW((void)differentiate(Eigen::MatrixXd::Zero(60, 1), 0.0, 1, 3), Error);
  EXPECT_THROW((void)differentiate(Eigen::MatrixXd::Zero(60, 1), 0.001, 3, 3), Error);
}

}  // namespace
}  // namespace deltadyn
