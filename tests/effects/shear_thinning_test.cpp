#include "deltadyn/effects/shear_thinning.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(ShearThinning, LacksFrictionAtLowSpeedAndIsOdd) {
  const auto law = [](double rate, double exponent) {
    return effects::ShearThinning::columns(sliding(rate), {0.5, exponent, 0})[0];
  };
  EXPECT_NEAR(law(1e-9, 0), -1.0, 1e-8);
  EXPECT_NEAR(law(5.0, 0), 0.0, 1e-4);
  EXPECT_EQ(law(-0.3, 0), -law(0.3, 0));
  EXPECT_NEAR(law(2.0, 0.5), 2.0, 1e-12);
  EXPECT_EQ(law(0.0, 0.5), 0.0);
}

TEST(ShearThinning, SaysWhereItsShapeIsAMatterOfUnitsOrOfRest) {
  constexpr EffectTraits traits = effects::ShearThinning::traits();
  const double power[] = {2, 0.5, 0}, slow[] = {0.01, 0, 0};
  EXPECT_TRUE(traits.is_unit(0, power));
  EXPECT_FALSE(traits.is_unit(0, slow));
  EXPECT_TRUE(traits.only_near_rest(slow, 5.0));
  EXPECT_FALSE(traits.only_near_rest(power, 500.0));
}

}  // namespace
}  // namespace deltadyn
