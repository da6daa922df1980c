#include "deltadyn/effects/load_dependent_friction.hpp"

#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(LoadDependentFriction, ResistsInProportionToTheLoadOfEitherSign) {
  EXPECT_EQ(effects::LoadDependentFriction::columns(sliding(1.0, -5.0), {})[0], 5.0);
  EXPECT_EQ(effects::LoadDependentFriction::columns(sliding(-1.0, -5.0), {})[0], -5.0);
}

}  // namespace
}  // namespace deltadyn
