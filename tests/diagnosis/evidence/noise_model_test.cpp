#include "../../../src/diagnosis/evidence/noise_model.hpp"

#include <gtest/gtest.h>

#include "diagnosis/evidence/autoregression.hpp"

namespace deltadyn {
namespace {

using Eigen::VectorXd;
using testing_support::autoregression;

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

TEST(NoiseModel, IsNotMadeOfTheFewLongRuns) {
  // Nearly all runs are short; the one that is longer ends in a line, which a high order would foretell without error.
  VectorXd e = 0.3 * autoregression(VectorXd(0), 400, 3);
  RowMask usable = RowMask::Constant(e.size(), true);
  for (Eigen::Index k = 5; k < 360; k += 6) usable(k) = false;
  e.tail(40) = 0.3 * VectorXd::LinSpaced(40, -1, 1);
  const NoiseModel model = fit_noise_model(e, usable);
  EXPECT_LE(model.order(), 4);
  EXPECT_GT(model.std, 0.2);
}

}  // namespace
}  // namespace deltadyn
