#include "deltadyn/effects/rotor_inertia.hpp"

#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(RotorInertia, IsProportionalToTheAcceleration) {
  JointInput<double> in;
  in.acceleration = -12.5;
  EXPECT_EQ(effects::RotorInertia::columns(in, {})[0], -12.5);
}

}  // namespace
}  // namespace deltadyn
