#include "deltadyn/effects/asymmetric_viscous.hpp"

#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(AsymmetricViscous, IsEvenInTheRate) {
  for (const double rate : {-2.0, 2.0}) EXPECT_EQ(effects::AsymmetricViscous::columns(sliding(rate), {})[0], 2.0);
}

}  // namespace
}  // namespace deltadyn
