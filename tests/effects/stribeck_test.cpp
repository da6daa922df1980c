#include "deltadyn/effects/stribeck.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(Stribeck, IsLargestAtRestAndFallsToItsEthAtItsRate) {
  const auto law = [](double rate) { return effects::Stribeck::columns(sliding(rate), {0.2, 2, 0})[0]; };
  EXPECT_NEAR(law(1e-9), 1.0, 1e-12);
  EXPECT_NEAR(law(0.2), std::exp(-1.0), 1e-12);
  EXPECT_EQ(law(-0.2), -law(0.2));
  EXPECT_LT(law(2.0), 1e-40);
}

}  // namespace
}  // namespace deltadyn
