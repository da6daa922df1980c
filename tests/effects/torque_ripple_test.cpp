#include "deltadyn/effects/torque_ripple.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(TorqueRipple, HasNWavesAUnit) {
  const auto wave = torque_ripple(0.25, 6.283185307179586);
  EXPECT_NEAR(wave.cosine, 0.0, 1e-12);
  EXPECT_NEAR(wave.sine, 1.0, 1e-12);
}

}  // namespace
}  // namespace deltadyn
