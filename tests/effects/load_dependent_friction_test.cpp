#include "deltadyn/effects/load_dependent_friction.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(LoadDependentFriction, ResistsInProportionToTheLoadOfEitherSign) {
  EXPECT_EQ(load_dependent_friction(1.0, -5.0), 5.0);
  EXPECT_EQ(load_dependent_friction(-1.0, -5.0), -5.0);
}

}  // namespace
}  // namespace deltadyn
