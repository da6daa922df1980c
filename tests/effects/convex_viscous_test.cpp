#include "deltadyn/effects/convex_viscous.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(ConvexViscous, IsOneAtItsReferenceAndGrowsFasterThanTheRate) {
  EXPECT_NEAR(convex_viscous(3.0, 2.0, 3.0), 1.0, 1e-12);
  EXPECT_NEAR(convex_viscous(-6.0, 2.0, 3.0), -4.0, 1e-12);
  EXPECT_EQ(convex_viscous(0.0, 2.0), 0.0);
}

}  // namespace
}  // namespace deltadyn
