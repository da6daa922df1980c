#include "deltadyn/effects/telescope_stribeck.hpp"

#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(TelescopeStribeck, IsStribecksLawOfTheBarsRate) {
  const Shape<double> shape{0.1, 1, 0};
  EXPECT_EQ(effects::TelescopeStribeck::columns(sliding(0.05), shape),
            effects::Stribeck::columns(sliding(0.05), shape));
}

}  // namespace
}  // namespace deltadyn
