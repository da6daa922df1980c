#include "deltadyn/effects/saturation.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(Saturation, LeavesSmallTorquesAlone) {
  EXPECT_EQ(saturation(4.0, 5.0), 0.0);
  EXPECT_EQ(saturation(7.0, 5.0), -2.0);
  EXPECT_EQ(saturation(-7.0, 5.0), 2.0);
}

}  // namespace
}  // namespace deltadyn
