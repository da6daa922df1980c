#include "deltadyn/effects/torque_ripple.hpp"

#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(TorqueRipple, HasNWavesAUnit) {
  const auto columns = effects::TorqueRipple::columns(at_position(0.25), {6.283185307179586});
  EXPECT_NEAR(columns[0], 0.0, 1e-12);
  EXPECT_NEAR(columns[1], 1.0, 1e-12);
}

}  // namespace
}  // namespace deltadyn
