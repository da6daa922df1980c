#include "deltadyn/effects/backlash.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(Backlash, IsFreeOnlyWhileTheGapIsCrossed) {
  Backlash<double> play(0.01);
  EXPECT_FALSE(play.move(0.1, 1.0));
  EXPECT_TRUE(play.move(-0.004, -1.0));
  EXPECT_TRUE(play.move(-0.004, -1.0));
  EXPECT_FALSE(play.move(-0.004, -1.0));
  EXPECT_FALSE(play.move(-1.0, -1.0));
  EXPECT_EQ(backlash(true, 3.0), -3.0);
  EXPECT_EQ(backlash(false, 3.0), 0.0);
}

}  // namespace
}  // namespace deltadyn
