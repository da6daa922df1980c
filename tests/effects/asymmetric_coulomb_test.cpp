#include "deltadyn/effects/asymmetric_coulomb.hpp"

#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(AsymmetricCoulomb, IsTheSameEitherWayAndAtRest) {
  for (const float rate : {-2.0F, 0.0F, 3.0F})
    EXPECT_EQ(effects::AsymmetricCoulomb::columns(sliding(rate), {})[0], 1.0F);
}

}  // namespace
}  // namespace deltadyn
