#include "deltadyn/effects/base_tilt.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(BaseTilt, TurnsGravityAndKeepsItsSizeToFirstOrder) {
  const Vector3<double> g(0, 0, -9.81);
  const Vector3<double> tilted = tilted_gravity(g, 0.01, 0.0);
  EXPECT_NEAR(tilted.y(), 0.0981, 1e-12);
  EXPECT_NEAR(tilted.norm(), 9.81, 1e-3);
}

}  // namespace
}  // namespace deltadyn
