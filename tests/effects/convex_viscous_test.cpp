#include "deltadyn/effects/convex_viscous.hpp"

#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(ConvexViscous, IsOneAtUnitRateAndGrowsFasterThanTheRate) {
  EXPECT_NEAR(effects::ConvexViscous::columns(sliding(1.0), {2})[0], 1.0, 1e-12);
  EXPECT_NEAR(effects::ConvexViscous::columns(sliding(-2.0), {2})[0], -4.0, 1e-12);
  EXPECT_EQ(effects::ConvexViscous::columns(sliding(0.0), {2})[0], 0.0);
}

}  // namespace
}  // namespace deltadyn
