#include "deltadyn/effects/thermal_drift.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(ThermalDrift, FadesWithItsTimeConstant) {
  JointInput<double> in = sliding(2.0);
  EXPECT_EQ(effects::ThermalDrift::columns(in, {5})[0], 2.0);
  in.time = 5;
  EXPECT_NEAR(effects::ThermalDrift::columns(in, {5})[0], 2.0 * std::exp(-1.0), 1e-12);
}

}  // namespace
}  // namespace deltadyn
