#include "deltadyn/effects/position_dependent_friction.hpp"

#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(PositionDependentFriction, FlipsWithTheDirection) {
  const auto there = effects::PositionDependentFriction::columns(at_position(0.3), {4});
  const auto back = effects::PositionDependentFriction::columns(at_position(0.3, -1.0), {4});
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(there[k], -back[k]);
}

}  // namespace
}  // namespace deltadyn
