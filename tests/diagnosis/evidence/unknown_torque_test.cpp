#include "../../../src/diagnosis/evidence/unknown_torque.hpp"

#include <Eigen/QR>
#include <gtest/gtest.h>
#include <random>

#include "deltadyn/identification/effect_columns.hpp"
#include "deltadyn/runtime/random.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kSamples = 2000;

/// A log of one drive at 1 kHz whose rows are low-passed at 25 Hz.
PreparedLog low_passed_log() {
  PreparedLog log;
  log.rate_hz = 1000;
  log.stride = 16;
  log.low_pass = std::make_shared<FirDecimator>(log.rate_hz, 25.0, static_cast<int>(log.stride));
  log.first = log.low_pass->half_width();
  log.rows = log.low_pass->outputs(kSamples);
  log.t_s = VectorXd::LinSpaced(kSamples, 0, (kSamples - 1) * 1e-3);
  log.tau = MatrixXd::Constant(kSamples, 1, 3.0);
  log.reversal.setConstant(kSamples, 1, false);
  return log;
}

/// Of a reversal of 12 ms from sample 900 on.
std::vector<UnknownTorque> of_a_quick_reversal(PreparedLog log) {
  log.reversal.block(900, 0, 12, 1).setConstant(true);
  RowMask present = RowMask::Constant(log.rows, true);
  return unknown_torque(log, 0, present);
}

/// Share of the rows' square that no combination of the directions gives.
double left(const std::vector<UnknownTorque>& unknown, const VectorXd& rows) {
  Index columns = 0;
  for (const UnknownTorque& one : unknown) columns += one.directions.cols();
  MatrixXd U = MatrixXd::Zero(rows.size(), columns);
  Index at = 0;
  for (const UnknownTorque& one : unknown) {
    U.block(one.first, at, one.directions.rows(), one.directions.cols()) = one.directions;
    at += one.directions.cols();
  }
  const VectorXd a = U.completeOrthogonalDecomposition().solve(rows);
  return (rows - U * a).squaredNorm() / rows.squaredNorm();
}

TEST(UnknownTorque, SpansWhateverHappensInTheStretch) {
  PreparedLog log = low_passed_log();
  log.reversal.block(900, 0, 30, 1).setConstant(true);
  log.reversal.block(1985, 0, 15, 1).setConstant(true);  // up to the end of the log
  RowMask present = RowMask::Constant(log.rows, true);
  const std::vector<UnknownTorque> unknown = unknown_torque(log, 0, present);
  ASSERT_EQ(unknown.size(), 2u);
  EXPECT_TRUE(present.all());
  std::mt19937 random(1);
  NormalDistribution normal;
  for (int trial = 0; trial < 20; ++trial) {
    MatrixXd tau = MatrixXd::Zero(kSamples, 1);
    for (Index k = 0; k < kSamples; ++k) {
      if (log.reversal(k, 0)) tau(k, 0) = normal(random);
    }
    EXPECT_LT(left(unknown, low_passed_rows(log, tau)), 1e-6);
  }
}

TEST(UnknownTorque, TakesFewDirectionsOfTheRowsInReach) {
  const std::vector<UnknownTorque> unknown = of_a_quick_reversal(low_passed_log());
  ASSERT_EQ(unknown.size(), 1u);
  const VectorXd size = unknown[0].directions.colwise().norm().transpose();
  EXPECT_GT(unknown[0].directions.rows(), 6);  // far more than directions
  EXPECT_LE((size.array() > 0.01 * size.maxCoeff()).count(), 5);
}

TEST(UnknownTorque, ShowsWhatHappensBesideTheStretch) {
  const PreparedLog log = low_passed_log();
  const std::vector<UnknownTorque> unknown = of_a_quick_reversal(log);
  MatrixXd tau = MatrixXd::Zero(kSamples, 1);
  tau.block(920, 0, 30, 1).setConstant(1.0);
  EXPECT_GT(left(unknown, low_passed_rows(log, tau)), 0.01);
}

TEST(UnknownTorque, KnowsNothingWhereAJointStands) {
  PreparedLog log = low_passed_log();
  log.reversal.block(400, 0, 1000, 1).setConstant(true);
  RowMask present = RowMask::Constant(log.rows, true);
  const std::vector<UnknownTorque> unknown = unknown_torque(log, 0, present);
  EXPECT_EQ(unknown.size(), 2u);
  const Index reach = log.low_pass->half_width();
  for (Index row = 0; row < log.rows; ++row) {
    const Index centre = sample_of_row(log, row);
    EXPECT_EQ(present(row), centre < 392 + reach || centre >= 1408 - reach);  // 8 ms early or late
  }
}

}  // namespace
}  // namespace deltadyn
