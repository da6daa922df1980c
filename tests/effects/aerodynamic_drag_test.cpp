#include "deltadyn/effects/aerodynamic_drag.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(AerodynamicDrag, GrowsWithTheSquareAlongTheVelocity) {
  const Vector3<double> v(1, -2, 2);
  EXPECT_LT((aerodynamic_drag(v) - 3 * v).norm(), 1e-12);
  EXPECT_LT((aerodynamic_drag<double>(2 * v) - 4 * aerodynamic_drag(v)).norm(), 1e-12);
}

}  // namespace
}  // namespace deltadyn
