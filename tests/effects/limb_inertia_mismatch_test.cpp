#include "deltadyn/effects/limb_inertia_mismatch.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(LimbInertiaMismatch, HoldsTheArmUpWhenItIsLevel) {
  EXPECT_NEAR(limb_inertia_mismatch(0.0, 2.0, 9.81).moment, -9.81, 1e-12);
  EXPECT_EQ(limb_inertia_mismatch(0.0, 2.0, 9.81).inertia, 2.0);
}

}  // namespace
}  // namespace deltadyn
