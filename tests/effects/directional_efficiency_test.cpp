#include "deltadyn/effects/directional_efficiency.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(DirectionalEfficiency, ItsTwoColumnsMakeLoadDependentFriction) {
  for (const double rate : {-1.0, 2.0}) {
    for (const double load : {-3.0, 4.0}) {
      const auto [driving, driven] = effects::DirectionalEfficiency::columns(sliding(rate, load), {});
      EXPECT_EQ(driving * driven, 0.0);
      EXPECT_EQ(driving + driven, std::abs(load) * (rate > 0 ? 1 : -1));
      EXPECT_EQ(driving != 0, load * rate > 0);
    }
  }
}

}  // namespace
}  // namespace deltadyn
