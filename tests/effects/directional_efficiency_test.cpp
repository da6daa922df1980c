#include "deltadyn/effects/directional_efficiency.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(DirectionalEfficiency, ItsTwoColumnsMakeLoadDependentFriction) {
  for (const double rate : {-1.0, 2.0}) {
    for (const double load : {-3.0, 4.0}) {
      const double driving = directional_efficiency(rate, load, EfficiencyColumn::driving);
      const double driven = directional_efficiency(rate, load, EfficiencyColumn::back_driving);
      EXPECT_EQ(driving * driven, 0.0);
      EXPECT_EQ(driving + driven, std::abs(load) * (rate > 0 ? 1 : -1));
      EXPECT_GE((driving + driven) * rate, 0.0);
    }
  }
}

}  // namespace
}  // namespace deltadyn
