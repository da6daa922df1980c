#include "deltadyn/diagnosis/noise_model.hpp"

#include <gtest/gtest.h>

#include "diagnosis/autoregression.hpp"

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

}  // namespace
}  // namespace deltadyn
