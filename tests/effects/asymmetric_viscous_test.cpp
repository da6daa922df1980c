#include "deltadyn/effects/asymmetric_viscous.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(AsymmetricViscous, IsEvenInTheRate) {
  EXPECT_EQ(asymmetric_viscous(-2.0), 2.0);
  EXPECT_EQ(asymmetric_viscous(2.0), 2.0);
}

}  // namespace
}  // namespace deltadyn
