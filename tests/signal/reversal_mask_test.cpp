#include "deltadyn/signal/reversal_mask.hpp"

#include <gtest/gtest.h>
#include <random>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/random.hpp"
#include "deltadyn/signal/butterworth.hpp"
#include "deltadyn/signal/differentiate.hpp"

#include "signal/multi_sine.hpp"

namespace deltadyn {
namespace {

using namespace deltadyn::testing_support;

TEST(ReversalMask, MarksSlowSamplesAndTheirNeighbours) {
  Eigen::VectorXd v(12);
  v << 3, 3, 3, 0.1, 3, 3, 3, 3, -3, -3, -3, -3;
  EXPECT_EQ(reversal_mask(v, 0.5, 0), (std::vector<char>{0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 0}));
  EXPECT_EQ(reversal_mask(v, 0.5, 1), (std::vector<char>{0, 0, 1, 1, 1, 0, 1, 1, 1, 1, 0, 0}));
  EXPECT_EQ(reversal_mask(v, 0.5, 100), std::vector<char>(12, 1));
  EXPECT_EQ(reversal_mask(v.cwiseAbs(), 0.0, 3), std::vector<char>(12, 0));
  EXPECT_THROW((void)reversal_mask(v, -1.0, 0), Error);
}

TEST(PositionNoise, MeetsGaussianNoiseAndQuantisation) {
  std::mt19937_64 random(1);
  NormalDistribution normal(0.0, 2e-5);
  const Eigen::VectorXd t = times(1000, 10000);
  const MultiSine motion;
  Eigen::VectorXd q = motion.at(t, 0);
  for (double& x : q) x += normal(random);
  EXPECT_NEAR(position_noise(q) / 2e-5, 1.0, 0.05);
  const double count = 2 * std::numbers::pi / std::pow(2.0, 19);
  EXPECT_NEAR(position_noise(quantised(motion.at(t, 0), 19)) / (count / std::sqrt(12.0)), 1.0, 0.15);
  EXPECT_EQ(position_noise(Eigen::VectorXd::Constant(100, 3.0)), 0.0);
}

TEST(DerivativeNoise, PredictsTheScatterBehindTheFilter) {
  std::mt19937_64 random(2);
  NormalDistribution normal;
  const Eigen::MatrixXd noise = Eigen::MatrixXd::NullaryExpr(100000, 1, [&] { return normal(random); });
  for (const double cutoff : {10.0, 40.0, 100.0}) {
    const Eigen::MatrixXd filtered = zero_phase_filter(noise, 1000, cutoff, 4);
    for (int derivative = 1; derivative <= 2; ++derivative) {
      const double scatter = rms(Eigen::VectorXd(differentiate(filtered, 0.001, derivative, 3)));
      EXPECT_NEAR(derivative_noise(1.0, 1000, cutoff, 4, derivative) / scatter, 1.0, 0.04)
          << cutoff << " " << derivative;
    }
  }
}

}  // namespace
}  // namespace deltadyn
