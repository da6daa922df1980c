// Noise beside structure: an offset must not become noise, slow noise must not become structure.

#include "../../../src/diagnosis/evidence/noise_estimate.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "deltadyn/runtime/random.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kRows = 2000;
constexpr double kRow_s = 0.005;

/// One drive that turns back and forth; its torque is the first base column times 2, plus what is given.
std::vector<LogRows> one_log(const VectorXd& more) {
  LogRows log;
  log.t_s = VectorXd::LinSpaced(kRows, 0, (kRows - 1) * kRow_s);
  log.q = (0.5 * (2.1 * log.t_s.array()).sin()).matrix();
  log.qd = (1.05 * (2.1 * log.t_s.array()).cos()).matrix();
  log.qdd = (-2.205 * (2.1 * log.t_s.array()).sin()).matrix();
  log.Y = {log.qdd};
  log.tau = 2 * log.qdd + more;
  log.usable = log.present = {RowMask::Constant(kRows, true)};
  log.unknown.resize(1);
  return {log};
}

/// A constant, and four waves over the position: two blocks.
GenericBasis small_basis(const std::vector<LogRows>& logs) {
  GenericBasis basis;
  MatrixXd columns(kRows, 5);
  for (Index k = 0; k < kRows; ++k) {
    columns(k, 0) = 1;
    for (int c = 1; c < 5; ++c) columns(k, c) = std::sin(c * 3.0 * logs[0].q(k, 0));
  }
  basis.columns = {{columns}};
  basis.coordinate = {{"constant", "position", "position", "position", "position"}};
  basis.blocks = {{{0, 1}, {1, 4}}};
  return basis;
}

VectorXd noise(double correlation, unsigned seed) {
  std::mt19937_64 random(seed);
  NormalDistribution normal;
  VectorXd e(kRows);
  double last = normal(random);
  for (Index k = 0; k < kRows; ++k)
    e(k) = last = correlation * last + std::sqrt(1 - correlation * correlation) * normal(random);
  return e;
}

TEST(NoiseEstimate, IsTheNoiseThatIsThere) {
  for (const double correlation : {0.0, 0.5, 0.9}) {
    double mean = 0;
    for (unsigned seed = 1; seed <= 8; ++seed) {
      const auto logs = one_log(noise(correlation, seed));
      mean += estimate_noise(logs, small_basis(logs), {}).floor_rms[0][0] / 8;
    }
    EXPECT_NEAR(mean, 1, 0.08) << "correlation " << correlation;
  }
}

TEST(NoiseEstimate, TakesAnOffsetForStructureNotForNoise) {
  const auto logs = one_log(noise(0, 3) + VectorXd::Constant(kRows, 8.0));
  const NoiseEstimate estimate = estimate_noise(logs, small_basis(logs), {});
  EXPECT_NEAR(estimate.floor_rms[0][0], 1, 0.1);
  EXPECT_NEAR(estimate.noise[0][0].total_std(), 1, 0.15);
}

TEST(NoiseEstimate, LikesTheModelThatHoldsTheEffect) {
  const auto logs = one_log(noise(0.5, 4) + VectorXd::Constant(kRows, 3.0));
  const GenericBasis basis = small_basis(logs);
  const PerLogAndDrive<MatrixXd> with = {{MatrixXd::Ones(kRows, 1)}};
  const PerLogAndDrive<MatrixXd> chance = {{noise(0, 9)}};
  const double without = estimate_noise(logs, basis, {}).log_likelihood;
  EXPECT_GT(estimate_noise(logs, basis, with).log_likelihood, without);
  EXPECT_LT(estimate_noise(logs, basis, chance).log_likelihood, without + 0.5 * std::log(static_cast<double>(kRows)));
}

TEST(NoiseModel, DampingBoundsItsMemory) {
  VectorXd drift(kRows);
  for (Index k = 0; k < kRows; ++k) drift(k) = 5;
  const VectorXd e = drift + noise(0, 5);
  const RowMask all = RowMask::Constant(kRows, true);
  const NoiseModel damped = fit_noise_model(e, all, 20, 0.97);
  // Poles within radius 0.97: what is remembered dies out.
  NoiseModel impulse = damped;
  impulse.std = 1;
  EXPECT_TRUE(std::isfinite(impulse.total_std()));
  EXPECT_GT(damped.std, 1.0);
}

TEST(NoiseModel, AWhiteShareKeepsTheVariance) {
  const VectorXd e = noise(0.95, 6);
  const NoiseModel fitted = fit_noise_model(e, RowMask::Constant(kRows, true));
  const NoiseModel floored = with_white_share(fitted, 0.1);
  EXPECT_NEAR(floored.total_std(), fitted.total_std(), 0.02 * fitted.total_std());
  EXPECT_GT(floored.std, 1.1 * fitted.std);
  EXPECT_EQ(with_white_share(NoiseModel(), 0.1).order(), 0);
}

}  // namespace
}  // namespace deltadyn
