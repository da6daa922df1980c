#include "deltadyn/effects/passive_joint_friction.hpp"

#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(PassiveJointFriction, IsCoulombsInEachJoint) {
  EXPECT_EQ(effects::PassiveJointFriction::columns(sliding(-0.2), {})[0], -1.0);
  EXPECT_EQ(effects::PassiveJointFriction::columns(sliding(3.0), {})[0], 1.0);
}

}  // namespace
}  // namespace deltadyn
