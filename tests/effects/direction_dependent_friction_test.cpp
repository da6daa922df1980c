#include "deltadyn/effects/direction_dependent_friction.hpp"

#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

std::array<double, 3> law(double rate) {
  return effects::DirectionDependentFriction::columns(sliding(rate), {0.1, 0, 0});
}

TEST(DirectionDependentFriction, IsTheDifferenceOfTheDirectionsBeyondItsDeadZone) {
  for (const double rate : {-2.0, 2.0}) EXPECT_EQ(law(rate), (std::array<double, 3>{1, 2, 0}));
}

TEST(DirectionDependentFriction, TakesAwayCoulombsFrictionWithinIt) {
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(law(0.05 * sign)[0], 0.0);
    EXPECT_EQ(law(0.05 * sign)[1], 0.0);
    EXPECT_EQ(law(0.05 * sign)[2], -sign);
    EXPECT_NEAR(law(0.1 * sign)[2], -0.5 * sign, 1e-12);
  }
}

}  // namespace
}  // namespace deltadyn
