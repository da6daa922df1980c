#include "deltadyn/effects/aerodynamic_drag.hpp"

#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(AerodynamicDrag, GrowsWithTheSquareAlongTheVelocity) {
  PlateInput<double> in;
  in.velocity << 1, -2, 2;
  EXPECT_LT((effects::AerodynamicDrag::columns(in, {})[0] - 3 * in.velocity).norm(), 1e-12);
  PlateInput<double> twice = in;
  twice.velocity *= 2;
  EXPECT_LT((effects::AerodynamicDrag::columns(twice, {})[0] - 12 * in.velocity).norm(), 1e-12);
}

}  // namespace
}  // namespace deltadyn
