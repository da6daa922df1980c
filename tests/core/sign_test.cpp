#include "deltadyn/core/sign.hpp"

#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(SignOf, IsThatOfTheRateWhateverItsSizeAndNothingAtRest) {
  for (const double rate : {1e-300, 1.0, 1e300}) {
    EXPECT_EQ(sign_of(rate), 1.0);
    EXPECT_EQ(sign_of(-rate), -1.0);
  }
  EXPECT_EQ(sign_of(-0.5F), -1.0F);
  EXPECT_EQ(sign_of(0.0), 0.0);
  EXPECT_EQ(sign_of(-0.0), 0.0);
}

}  // namespace
}  // namespace deltadyn
