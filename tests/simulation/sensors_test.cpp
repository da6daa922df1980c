#include "deltadyn/simulation/sensors.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "deltadyn/runtime/error.hpp"

#include "simulation/effect_of.hpp"

namespace deltadyn {
namespace {

using testing_support::effect_of;

TEST(Encoders, CountInSteps) {
  SensorOptions options;
  options.encoder_step = {0.01, 0};
  Encoders encoders(2, options, 1);
  const Eigen::VectorXd reading = encoders.read(Eigen::Vector2d(0.1234, 0.1234));
  EXPECT_NEAR(reading(0), 0.12, 1e-15);
  EXPECT_EQ(reading(1), 0.1234);
}

TEST(Encoders, NoiseHasTheGivenSize) {
  SensorOptions options;
  options.encoder_noise = {0.01};
  Encoders encoders(1, options, 1);
  double squares = 0;
  constexpr int kCount = 20000;
  for (int k = 0; k < kCount; ++k) squares += std::pow(encoders.read(Eigen::VectorXd::Zero(1))(0), 2);
  EXPECT_NEAR(std::sqrt(squares / kCount), 0.01, 2e-4);
}

class Recorded : public ::testing::Test {
 protected:
  static constexpr Eigen::Index kRows = 4000;
  Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(kRows, 0, (kRows - 1) * 1e-3);
  Eigen::VectorXd tau = 10 * (2 * std::numbers::pi * 3 * t).array().sin();

  [[nodiscard]] Eigen::VectorXd with(const Effect& effect) const {
    return recorded_torque(t, tau, {effect}, {}, 1).col(0);
  }
};

TEST_F(Recorded, NoiseHasItsSizeAndItsCorrelation) {
  SensorOptions options;
  options.torque_noise = {0.5};
  for (const double rho : {0.0, 0.9}) {
    options.torque_noise_correlation = rho;
    const Eigen::VectorXd noise = recorded_torque(t, tau, {}, options, 7).col(0) - tau;
    EXPECT_NEAR(std::sqrt(noise.squaredNorm() / kRows), 0.5, rho > 0 ? 0.1 : 0.02);
    EXPECT_NEAR(noise.head(kRows - 1).dot(noise.tail(kRows - 1)) / noise.squaredNorm(), rho, 0.05);
  }
}

TEST_F(Recorded, TimeSkewDelaysTheTorque) {
  const Eigen::VectorXd late = with(effect_of(effect_id<effects::TimeSkew>, -1, {0.0024}, {0.0024}));
  const Eigen::VectorXd exact = 10 * (2 * std::numbers::pi * 3 * (t.array() - 0.0024)).sin();
  EXPECT_LT((late - exact).segment(10, kRows - 20).cwiseAbs().maxCoeff(), 1e-5);
}

TEST_F(Recorded, LagIsAFirstOrderLowPass) {
  constexpr double T = 0.005, w = 2 * std::numbers::pi * 3;
  const Eigen::VectorXd lagged = with(effect_of(effect_id<effects::CurrentLag>, 0, {T}, {T}));
  const Eigen::VectorXd exact = 10 / std::sqrt(1 + w * w * T * T) * (w * t.array() - std::atan(w * T)).sin();
  EXPECT_LT((lagged - exact).tail(kRows - 100).cwiseAbs().maxCoeff(), 2e-3);
}

TEST_F(Recorded, CommandBeforeTheLagLeadsTheTorque) {
  constexpr double T = 0.005, w = 2 * std::numbers::pi * 3;
  const Eigen::VectorXd command = with(effect_of(effect_id<effects::CurrentLag>, 0, {T}, {T, 1}));
  const Eigen::VectorXd exact = 10 * ((w * t.array()).sin() + w * T * (w * t.array()).cos());
  EXPECT_LT((command - exact).segment(10, kRows - 20).cwiseAbs().maxCoeff(), 1e-3);
}

TEST_F(Recorded, SaturationAndTorqueConstant) {
  EXPECT_NEAR(with(effect_of(effect_id<effects::Saturation>, 0, {1}, {6})).maxCoeff(), 6, 1e-12);
  EXPECT_NEAR(with(effect_of(effect_id<effects::Saturation>, 0, {0.5}, {6})).maxCoeff(), 8, 1e-3);
  EXPECT_LT(
      (with(effect_of(effect_id<effects::TorqueConstantError>, 0, {0.05}, {})) - 1.05 * tau).cwiseAbs().maxCoeff(),
      1e-12);
}

TEST_F(Recorded, EffectsOfThePlantAreNoneOfTheLog) {
  EXPECT_EQ(with(effect_of(effect_id<effects::Stribeck>, 0, {2}, {0.3, 1})), tau);
}

TEST(SensorOptions, RefuseWhatCannotBe) {
  SensorOptions options;
  options.torque_noise_correlation = 1;
  EXPECT_THROW(options.validate(2), Error);
  options = {};
  options.torque_noise = {0.1};
  EXPECT_THROW(options.validate(2), Error);
}

}  // namespace
}  // namespace deltadyn
