#include "deltadyn/effects/coulomb_friction.hpp"

#include <gtest/gtest.h>
#include <limits>

namespace deltadyn {
namespace {

TEST(CoulombFriction, HasTheSignOfTheRateWhateverItsSize) {
  for (const double rate : {1e-300, 1.0, 1e300}) {
    EXPECT_EQ(coulomb_friction(rate), 1.0);
    EXPECT_EQ(coulomb_friction(-rate), -1.0);
  }
  EXPECT_EQ(coulomb_friction(-0.5F), -1.0F);
}

TEST(CoulombFriction, IsNothingAtRest) {
  EXPECT_EQ(coulomb_friction(0.0), 0.0);
  EXPECT_EQ(coulomb_friction(-0.0), 0.0);
}

}  // namespace
}  // namespace deltadyn
