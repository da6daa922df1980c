#include "deltadyn/diagnosis/noise_model.hpp"

#include <gtest/gtest.h>
#include <random>

namespace deltadyn {
namespace {

using Eigen::VectorXd;

VectorXd autoregression(const VectorXd& ar, Eigen::Index rows, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  VectorXd e = VectorXd::Zero(rows);
  for (Eigen::Index t = 0; t < rows; ++t) {
    e(t) = normal(random);
    for (Eigen::Index k = 0; k < std::min(t, ar.size()); ++k) e(t) += ar(k) * e(t - 1 - k);
  }
  return e;
}

TEST(NoiseModel, FindsAnAutoregressionAndItsOrder) {
  const VectorXd ar = Eigen::Vector2d(1.4, -0.5);
  const VectorXd e = 0.3 * autoregression(ar, 20000, 1);
  const NoiseModel model = fit_noise_model(e, RowMask::Constant(e.size(), true));
  ASSERT_GE(model.order(), 2);
  EXPECT_LE(model.order(), 4);
  EXPECT_NEAR(model.ar(0), 1.4, 0.03);
  EXPECT_NEAR(model.ar(1), -0.5, 0.04);
  EXPECT_NEAR(model.std, 0.3, 0.01);
  EXPECT_NEAR(model.total_std(), std::sqrt(e.squaredNorm() / static_cast<double>(e.size())), 0.1 * model.total_std());
}

TEST(NoiseModel, TakesWhiteNoiseAsWhite) {
  const VectorXd e = autoregression(VectorXd(0), 5000, 2);
  EXPECT_LE(fit_noise_model(e, RowMask::Constant(e.size(), true)).order(), 1);
}

TEST(Whitener, MakesWhiteRowsAroundGapsAndLosesNoUsableRow) {
  const VectorXd ar = VectorXd::Constant(1, 0.95);
  RowMask usable = RowMask::Constant(4000, true);
  for (Eigen::Index t = 50; t + 30 < usable.size(); t += 100) usable.segment(t, 20).setConstant(false);
  NoiseModel model;
  model.ar = ar;
  const Whitener whitener(model, usable);
  EXPECT_GE(whitener.rows(), usable.count() - 1);
  const VectorXd white = whitener.apply(autoregression(ar, 4000, 3));
  EXPECT_NEAR(white.squaredNorm() / static_cast<double>(white.size()), 1.0, 0.08);
  const Eigen::Index n = white.size();
  EXPECT_NEAR(white.head(n - 1).dot(white.tail(n - 1)) / white.squaredNorm(), 0.0, 0.06);
}

TEST(Whitener, DoesNotCareWhatStandsInAGap) {
  RowMask usable = RowMask::Constant(300, true);
  usable.segment(100, 25).setConstant(false);
  NoiseModel model;
  model.ar = Eigen::Vector2d(1.2, -0.4);
  model.std = 0.5;
  const Whitener whitener(model, usable);
  const VectorXd e = autoregression(model.ar, 300, 4);
  VectorXd other = e;
  other.segment(100, 25).setConstant(1e6);
  EXPECT_LT((whitener.apply(e) - whitener.apply(other)).norm(), 1e-6);
}

}  // namespace
}  // namespace deltadyn
