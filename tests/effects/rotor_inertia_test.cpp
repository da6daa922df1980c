#include "deltadyn/effects/rotor_inertia.hpp"

#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(RotorInertia, IsProportionalToTheAcceleration) {
  EXPECT_EQ(rotor_inertia(-12.5), -12.5);
  EXPECT_EQ(rotor_inertia(3.0F), 3.0F);
}

}  // namespace
}  // namespace deltadyn
