#include "deltadyn/effects/current_lag.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(CurrentLag, ReachesMostOfAStepAfterItsTime) {
  CurrentLag<double> lag(0.003, 0.0);
  double y = 0;
  for (int k = 0; k < 300; ++k) y = lag.step(1.0, 1e-5);
  EXPECT_NEAR(y, 1 - std::exp(-1.0), 1e-9);
  EXPECT_EQ(current_lag(2.0, 10.0, 0.1), -1.0);
  EXPECT_EQ(current_lead(2.0), 2.0);
}

}  // namespace
}  // namespace deltadyn
