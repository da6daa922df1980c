#include "deltadyn/core/smooth_sign.hpp"

#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(SmoothSign, IsTheSignFarFromRestAndZeroAtRest) {
  EXPECT_EQ(smooth_sign(0.0, 0.1), 0);
  EXPECT_NEAR(smooth_sign(0.1, 0.1), std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(smooth_sign(-0.03, 0.1), -0.03 / std::hypot(0.03, 0.1), 1e-15);
  EXPECT_NEAR(smooth_sign(-0.4, 0.1), -0.4 / std::hypot(0.4, 0.1), 1e-15);
  EXPECT_NEAR(smooth_sign(1e6, 0.1), 1, 1e-12);
}

TEST(SmoothSign, OfWidthZeroIsTheSign) {
  EXPECT_EQ(smooth_sign(1e-300, 0.0), 1);
  EXPECT_EQ(smooth_sign(-2.0, 0.0), -1);
  EXPECT_EQ(smooth_sign(0.0, 0.0), 0);
}

TEST(SmoothSign, SquaresNothingThatOverflows) {
  EXPECT_EQ(smooth_sign(1e38F, 1e-30F), 1);
  EXPECT_EQ(smooth_sign(-3e38F, 1.0F), -1);
  EXPECT_NEAR(smooth_sign(1e38F, 1e38F), 0.70710678F, 1e-6F);
  EXPECT_GT(smooth_sign(1e-38F, 1.0F), 0);
}

}  // namespace
}  // namespace deltadyn
