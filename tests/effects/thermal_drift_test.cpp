#include "deltadyn/effects/thermal_drift.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(ThermalDrift, FadesWithItsTimeConstant) {
  EXPECT_EQ(thermal_drift(2.0, 0.0, 5.0), 2.0);
  EXPECT_NEAR(thermal_drift(2.0, 5.0, 5.0), 2.0 * std::exp(-1.0), 1e-12);
}

}  // namespace
}  // namespace deltadyn
