#include "deltadyn/effects/joint_elasticity.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "deltadyn/runtime/random.hpp"

namespace deltadyn {
namespace {

/// A motor turns an arm through a spring, all on one axis and without damping, so that a harmonic motion has a closed
/// form.
template <class T>
class JointElasticity : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(JointElasticity, Scalars);

TYPED_TEST(JointElasticity, IsTheFirstTermOfTheExactTorqueWithTheEncoderOnTheMotor) {
  using T = TypeParam;
  std::mt19937_64 random(1);
  UniformDistribution uniform(0, 1);
  for (int trial = 0; trial < 200; ++trial) {
    const double motor = 0.05 + 0.3 * uniform(random), arm = 0.1 + 0.5 * uniform(random),
                 k = 1e3 + 1e4 * uniform(random);
    const double w = std::sqrt(k / arm) * (0.05 + 0.25 * uniform(random)), theta = uniform(random) - 0.5;
    const double ratio = arm * w * w / k;  // square of frequency over resonance
    const double exact = -arm * w * w * theta * ratio / (1 - ratio);
    // The rigid torque for a lag x is (motor + arm) d2x/dt2; the lag is the load less the motor's share of it.
    const double inertia = motor + arm, fourth = std::pow(w, 4) * theta;
    ElasticInput<T> in;
    in.inertia = T(inertia);
    in.load_dd = T(inertia * fourth);
    in.snap = T(fourth);
    in.load_lag = T(inertia * inertia * fourth);
    in.inertia_lag = T(inertia * inertia * fourth);
    const T column = effects::JointElasticity::column(in, {T(1), T(motor / inertia), T(0)});
    EXPECT_NEAR(arm / k * static_cast<double>(column), exact,
                1.0001 * ratio * std::abs(exact) + 1e-5 * std::abs(exact));
  }
}

TYPED_TEST(JointElasticity, IsExactWithTheEncoderOnTheArmAndOfItsOwnDriveAlone) {
  using T = TypeParam;
  const double motor = 0.2, arm = 0.4, k = 3000, w = 40, q = 0.3;
  const double theta = q - arm * w * w * q / k;
  const double exact = -motor * w * w * theta - arm * w * w * q, rigid = -(motor + arm) * w * w * q;
  ElasticInput<T> in;
  in.inertia = T(motor + arm);
  in.load_dd = T((motor + arm) * std::pow(w, 4) * q);
  in.snap = T(std::pow(w, 4) * q);
  const Shape<T> shape{T(0), T(motor / (motor + arm)), T(0)};
  const T column = effects::JointElasticity::column(in, shape);
  EXPECT_NEAR(motor / k * static_cast<double>(column), exact - rigid, 1e-5 * std::abs(exact - rigid));
  in.own = false;
  EXPECT_EQ(effects::JointElasticity::column(in, shape), T(0));
}

TEST(JointElasticityResonance, IsThatOfTheSideAwayFromTheEncoder) {
  const double amplitude = 1 / std::pow(2 * 3.14159265358979 * 25, 2);
  EXPECT_NEAR(effects::JointElasticity::traits().resonance_hz(&amplitude), 25, 1e-9);
}

}  // namespace
}  // namespace deltadyn
