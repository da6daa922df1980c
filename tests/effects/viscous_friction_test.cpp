#include "deltadyn/effects/viscous_friction.hpp"

#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(ViscousFriction, GrowsWithTheRateAndOpposesIt) {
  EXPECT_EQ(viscous_friction(2.5), 2.5);
  EXPECT_EQ(viscous_friction(-2.5F), -2.5F);
  for (const double rate : {-3.0, -0.1, 0.2, 4.0}) EXPECT_GT(rate * viscous_friction(rate), 0) << "friction takes power";
}

}  // namespace
}  // namespace deltadyn
