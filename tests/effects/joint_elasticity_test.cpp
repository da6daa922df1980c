#include "deltadyn/effects/joint_elasticity.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "deltadyn/runtime/random.hpp"

namespace deltadyn {
namespace {

/// A motor turns an arm through a spring, all on one axis and without damping, so that a harmonic motion has a closed form.
template <class T>
class JointElasticity : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(JointElasticity, Scalars);

TYPED_TEST(JointElasticity, IsTheFirstTermOfTheExactTorqueWithTheEncoderOnTheMotor) {
  using T = TypeParam;
  std::mt19937_64 random(1);
  UniformDistribution uniform(0, 1);
  for (int trial = 0; trial < 200; ++trial) {
    const double motor = 0.05 + 0.3 * uniform(random), arm = 0.1 + 0.5 * uniform(random), k = 1e3 + 1e4 * uniform(random);
    const double w = std::sqrt(k / arm) * (0.05 + 0.25 * uniform(random)), theta = uniform(random) - 0.5;
    const double ratio = arm * w * w / k;  // square of frequency over resonance
    const double exact = -arm * w * w * theta * ratio / (1 - ratio);
    // The rigid model's torque for a lag x is (motor + arm) d2x/dt2, and the lag is the arm's torque.
    const double passed_dd = arm * std::pow(w, 4) * theta;
    const T column = joint_elasticity(T((motor + arm) * passed_dd), T(motor * passed_dd), T(arm));
    EXPECT_NEAR(arm / k * static_cast<double>(column), exact, 1.0001 * ratio * std::abs(exact) + 1e-6 * std::abs(exact));
  }
}

TYPED_TEST(JointElasticity, IsExactWithTheEncoderOnTheArm) {
  using T = TypeParam;
  const double motor = 0.2, arm = 0.4, k = 3000, w = 40, q = 0.3;
  const double theta = q - arm * w * w * q / k;
  const double exact = -motor * w * w * theta - arm * w * w * q, rigid = -(motor + arm) * w * w * q;
  const T column = joint_elasticity(T(arm * std::pow(w, 4) * q));
  EXPECT_NEAR(motor / k * static_cast<double>(column), exact - rigid, 1e-5 * std::abs(exact - rigid));
}

}  // namespace
}  // namespace deltadyn
