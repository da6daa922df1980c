#include "deltadyn/effects/stribeck.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(Stribeck, IsLargestAtRestAndFallsToItsEthAtItsRate) {
  const StribeckShape<double> shape{0.2, 2.0};
  EXPECT_NEAR(stribeck(1e-9, shape), 1.0, 1e-12);
  EXPECT_NEAR(stribeck(0.2, shape), std::exp(-1.0), 1e-12);
  EXPECT_EQ(stribeck(-0.2, shape), -stribeck(0.2, shape));
  EXPECT_LT(stribeck(2.0, shape), 1e-40);
}

}  // namespace
}  // namespace deltadyn
