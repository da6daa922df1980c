#include "deltadyn/effects/hysteresis.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(Hysteresis, ClosesALoopWithinItsBounds) {
  Hysteresis<double> loop({0.1, 2.0});
  double up = 0, down = 0, area = 0;
  for (int k = 0; k < 400; ++k) up = loop.move(0.005);
  for (int k = 0; k < 400; ++k) area += 0.005 * (up - loop.move(-0.005));
  down = loop.state();
  EXPECT_NEAR(up, 1.0, 0.02);
  EXPECT_NEAR(down, -1.0, 0.02);
  EXPECT_GT(area, 0.0);
}

}  // namespace
}  // namespace deltadyn
