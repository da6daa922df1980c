#include "deltadyn/signal/resample.hpp"

#include <gtest/gtest.h>
#include <random>

#include "deltadyn/runtime/random.hpp"

namespace deltadyn {
namespace {

TEST(Resample, IsExactForCubicsOnUnevenTimes) {
  std::mt19937_64 random(5);
  UniformDistribution step(0.2, 1.8);
  Eigen::VectorXd t(50);
  t(0) = 0;
  for (Eigen::Index i = 1; i < 50; ++i) t(i) = t(i - 1) + step(random);
  const auto cubic = [](const Eigen::ArrayXd& x) { return (1.0 - x + 0.3 * x.square() - 0.01 * x.cube()).matrix(); };
  Eigen::MatrixXd columns(50, 2);
  columns << cubic(t.array()), t;
  const Eigen::VectorXd wanted = Eigen::VectorXd::LinSpaced(200, t(0), t(49));
  const Eigen::MatrixXd got = resample(t, columns, wanted);
  EXPECT_LT((got.col(0) - cubic(wanted.array())).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((got.col(1) - wanted).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace deltadyn
