#include "deltadyn/effects/arm_spring.hpp"

#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(ArmSpring, PullsToItsZero) {
  EXPECT_EQ(effects::ArmSpring::columns(at_position(0.5), {0.2})[0], 0.3);
  EXPECT_EQ(effects::ArmSpring::columns(at_position(0.2), {0.2})[0], 0.0);
  EXPECT_LT(effects::ArmSpring::columns(at_position(-0.5), {0.2})[0], 0.0);
}

}  // namespace
}  // namespace deltadyn
