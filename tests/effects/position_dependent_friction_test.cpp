#include "deltadyn/effects/position_dependent_friction.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(PositionDependentFriction, FlipsWithTheDirection) {
  const auto there = position_dependent_friction(0.3, 1.0, 4.0), back = position_dependent_friction(0.3, -1.0, 4.0);
  EXPECT_EQ(there.cosine, -back.cosine);
  EXPECT_EQ(there.sine, -back.sine);
}

}  // namespace
}  // namespace deltadyn
