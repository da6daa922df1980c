#include "deltadyn/effects/shear_thinning.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(ShearThinning, LacksFrictionAtLowSpeedAndIsOdd) {
  const ShearThinningShape<double> shape{0.5, 0.5};
  EXPECT_NEAR(shear_thinning(1e-9, shape), -1.0, 1e-8);
  EXPECT_NEAR(shear_thinning(5.0, shape), 0.0, 1e-4);
  EXPECT_EQ(shear_thinning(-0.3, shape), -shear_thinning(0.3, shape));
  EXPECT_NEAR(shear_thinning(2.0, shape, ShearLaw::power), 2.0, 1e-12);
  EXPECT_EQ(shear_thinning(0.0, shape, ShearLaw::power), 0.0);
}

}  // namespace
}  // namespace deltadyn
