#include "deltadyn/identification/residual_structure.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "deltadyn/runtime/random.hpp"

namespace deltadyn {
namespace {

constexpr Eigen::Index kRows = 2000;

Eigen::VectorXd noise(std::uint64_t seed, double memory = 0.0) {
  std::mt19937_64 random(seed);
  NormalDistribution normal;
  Eigen::VectorXd e(kRows);
  double state = 0;
  for (Eigen::Index k = 0; k < kRows; ++k)
    e(k) = state = memory * state + std::sqrt(1 - memory * memory) * normal(random);
  return e;
}

/// A motion that never repeats.
Eigen::VectorXd motion() {
  return Eigen::VectorXd::NullaryExpr(kRows, [](Eigen::Index k) {
    const auto t = 0.01 * static_cast<double>(k);
    return std::sin(2.1 * t) + 0.7 * std::sin(3.7 * t + 1) + 0.5 * std::sin(5.3 * t + 2);
  });
}

TEST(DependenceOnMotion, FindsTheShareThatACurveExplains) {
  const Eigen::VectorXd x = motion(), e = noise(1);
  const Eigen::VectorXd curve = x.array().tanh();
  const double variance = curve.squaredNorm() / static_cast<double>(kRows);
  const DependenceOnMotion found = dependence_on(x, curve + std::sqrt(variance) * e);  // half and half
  EXPECT_NEAR(found.share, 0.5, 0.1);  // shifts of a smooth motion follow it a little, too: the share comes out low
  EXPECT_LE(found.p_value, 0.01);
  EXPECT_GT(dependence_on(x, curve).share, 0.95);
}

TEST(DependenceOnMotion, NoiseDependsOnNothingEvenWithAMemory) {
  const Eigen::VectorXd x = motion();
  for (const double memory : {0.0, 0.9, 0.98}) {
    int alarms = 0;
    double share = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      const DependenceOnMotion found = dependence_on(x, noise(seed, memory));
      alarms += found.p_value <= 0.01 ? 1 : 0;
      share += found.share / 40;
    }
    EXPECT_LE(alarms, 3) << memory;  // 0.4 expected; more than 3 has a chance of 1e-3
    EXPECT_LT(share, 0.05) << memory;
  }
}

TEST(DependenceOnMotion, TooFewRowsSayNothing) {
  const DependenceOnMotion found = dependence_on(motion().head(50), motion().head(50));
  EXPECT_EQ(found.share, 0);
  EXPECT_EQ(found.p_value, 1);
  EXPECT_EQ(dependence_on(motion(), Eigen::VectorXd::Zero(kRows)).share, 0);
}

TEST(ResidualStructure, TellsTheCoordinateAndLeavesReversalsOut) {
  Validation validation;
  validation.drives.resize(2);
  validation.logs.resize(1);
  ValidatedLog& log = validation.logs[0];
  log.row_rate_hz = 100;
  Prediction& p = log.prediction;
  const Eigen::VectorXd x = motion();
  p.t_s = Eigen::VectorXd::LinSpaced(kRows, 0, 20);
  for (Eigen::MatrixXd* m : {&p.tau, &p.model, &p.q, &p.qd, &p.qdd}) *m = Eigen::MatrixXd::Zero(kRows, 2);
  p.q.col(0) = p.q.col(1) = x;
  p.qd.col(0) = p.qd.col(1) = noise(5, 0.99);  // has nothing to do with q
  p.qdd.col(0) = p.qdd.col(1) = noise(6, 0.99);
  p.tau.col(0) = p.qd.col(0).array().tanh().matrix() + 0.3 * noise(2);
  p.tau.col(1) = noise(3);
  p.use.setConstant(kRows, 2, RowUse::regular);
  p.use.col(0).head(300).setConstant(RowUse::reversal);
  p.tau.col(0).head(300).array() += 100;

  const std::vector<ResidualStructure> structure = residual_structure(validation);
  ASSERT_EQ(structure.size(), 2U);
  EXPECT_EQ(structure[0].rows, kRows - 300);
  EXPECT_GT(structure[0].on_velocity.share, 0.5);
  EXPECT_LE(structure[0].on_velocity.p_value, 0.01);
  EXPECT_LT(structure[0].on_position.share, 0.1);
  EXPECT_GT(structure[0].correlation, 3);
  EXPECT_LT(structure[1].on_velocity.share, 0.05);
  EXPECT_NEAR(structure[1].correlation, 1, 0.5);
}

}  // namespace
}  // namespace deltadyn
