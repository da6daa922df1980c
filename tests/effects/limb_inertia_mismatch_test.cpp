#include "deltadyn/effects/limb_inertia_mismatch.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(LimbInertiaMismatch, HoldsTheArmUpWhenItIsLevel) {
  JointInput<double> in;
  in.acceleration = 2;
  in.gravity_z = -9.81;
  const auto columns = effects::LimbInertiaMismatch::columns(in, {});
  EXPECT_NEAR(columns[0], -9.81, 1e-12);
  EXPECT_EQ(columns[1], 2.0);
}

TEST(LimbInertiaMismatch, FollowsGravityWhereverItPoints) {
  // The potential of a unit first moment along the arm is -g . direction; its derivative by the angle is the torque.
  for (const double q : {-0.4, 0.3, 1.2}) {
    JointInput<double> in;
    in.position = q;
    in.gravity_x = 3;
    in.gravity_z = -9;
    const auto potential = [&in](double a) { return -(in.gravity_x * std::cos(a) - in.gravity_z * std::sin(a)); };
    EXPECT_NEAR(effects::LimbInertiaMismatch::columns(in, {})[0], (potential(q + 1e-5) - potential(q - 1e-5)) / 2e-5,
                1e-8);
  }
}

}  // namespace
}  // namespace deltadyn
