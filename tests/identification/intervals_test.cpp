// The stated intervals are right: repeated with fresh noise of a known size, they cover the truth as often as they say.

#include <Eigen/Cholesky>
#include <cmath>
#include <gtest/gtest.h>
#include <iostream>
#include <random>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/identification/identify.hpp"
#include "deltadyn/identification/log_processing.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"
#include "deltadyn/runtime/random.hpp"

#include "../../src/identification/data_fold.hpp"
#include "../../src/identification/least_squares.hpp"
#include "identification/synthetic_log.hpp"

namespace deltadyn {
namespace {

TEST(Intervals, CoverTheTruthAndMeetTheCramerRaoBound) {
  constexpr int kRepetitions = 200;
  const Eigen::Vector4d sigma(0.3, 0.1, 0.5, 0.01);  // [N m], a different one for each drive
  const auto robot = make_robot(testing_support::delta_description("delta4"));
  const Eigen::VectorXd p = testing_support::delta_truth(*robot);
  const BaseParameters base = find_base_parameters(*robot);
  const Eigen::VectorXd truth = base.B * p;
  testing_support::SyntheticOptions motion;
  motion.rate_hz = 250;
  const Log clean = testing_support::synthetic_log(*robot, p, motion);
  ProcessingOptions as_it_is;
  as_it_is.filter = false;

  // Cramer-Rao: the inverse of the information in tau = Y_B beta + noise of known size.
  const PreparedLog prepared = prepare_log(*robot, clean, as_it_is);
  RowBlock block;
  read_rows(*robot, prepared, 0, prepared.rows, block);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(base.count(), base.count());
  for (int j = 0; j < 4; ++j) {
    Eigen::MatrixXd Y_B(block.rows(), base.count());
    for (int k = 0; k < base.count(); ++k)
      Y_B.col(k) = block.Y[static_cast<std::size_t>(j)].col(base.independent[static_cast<std::size_t>(k)]);
    information += Y_B.transpose() * Y_B / (sigma(j) * sigma(j));
  }
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::VectorXd bound =
      scale.asDiagonal() * Eigen::MatrixXd(scaled.ldlt().solve(Eigen::MatrixXd::Identity(base.count(), base.count())))
                               .diagonal()
                               .cwiseProduct(scale);
  ASSERT_GT(bound.minCoeff(), 0);

  std::mt19937_64 random(2024);
  NormalDistribution normal;
  int covered = 0;
  Eigen::VectorXd square_error = Eigen::VectorXd::Zero(base.count()), stated = square_error;
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    Log log = clean;
    for (Eigen::Index k = 0; k < log.tau.rows(); ++k) {
      for (int j = 0; j < 4; ++j) log.tau(k, j) += sigma(j) * normal(random);
    }
    const DataFold fold = fold_log(*robot, prepare_log(*robot, log, as_it_is));
    const BaseEstimate estimate = estimate_base_parameters(base, fold.regular);
    const Eigen::VectorXd error = estimate.value - truth;
    covered += static_cast<int>((error.array().abs() <= 1.96 * estimate.std().array()).count());
    square_error += error.cwiseAbs2() / kRepetitions;
    stated += estimate.std().cwiseAbs2() / kRepetitions;
  }
  const double coverage = 100.0 * covered / (kRepetitions * base.count());
  const double of_errors = square_error.cwiseQuotient(bound).mean(), of_statements = stated.cwiseQuotient(bound).mean();
  std::cout << "figure coverage_percent " << coverage << " target 93 to 97\n"
            << "figure variance_of_the_errors_over_cramer_rao " << of_errors << " target 0.9 to 1.1\n"
            << "figure stated_variance_over_cramer_rao " << of_statements << " target 0.9 to 1.1\n";
  EXPECT_GE(coverage, 93);
  EXPECT_LE(coverage, 97);
  EXPECT_NEAR(of_errors, 1, 0.1);
  EXPECT_NEAR(of_statements, 1, 0.1);
}

// Coulomb's friction turns round a little before or after the filtered rate says so. Rows there must neither bend the
// parameters farther than they are said to be known, nor pass for ripples.
TEST(Intervals, CoverTheTruthBesideReversals) {
  int covered = 0, count = 0;
  std::size_t ripples = 0;
  for (const char* type : {"delta3", "h4", "par4"}) {
    const auto robot = make_robot(testing_support::description_of(type));
    const Eigen::VectorXd p = testing_support::delta_truth(*robot);
    const NominalParameters prior = nominal_parameters(*robot, PartShapes(robot->description()));
    for (const std::uint64_t seed : {21U, 22U, 23U}) {
      testing_support::SyntheticOptions motion;
      motion.duration_s = 12;
      motion.base_frequency_hz = 0.4;
      motion.torque_noise = 0.05;
      motion.encoder_step = 2 * 3.14159265358979 / (1 << 19);
      motion.with_derivatives = false;
      motion.seed = seed;
      const Identification found =
          identify(*robot, {testing_support::synthetic_log(*robot, p, motion)}, prior.value, prior.std, {});
      const Eigen::VectorXd error = found.base_estimate.value - found.base.B * p;
      covered += static_cast<int>((error.array().abs() <= 1.96 * found.base_estimate.std().array()).count());
      count += found.base.count();
      ripples += found.processing.ripples.size();
    }
  }
  const double coverage = 100.0 * covered / count;
  std::cout << "figure coverage_beside_reversals_percent " << coverage << " target 85\n"
            << "figure ripples_that_are_none " << ripples << " target 0\n";
  EXPECT_GE(coverage, 85);
  EXPECT_EQ(ripples, 0U);
}

}  // namespace
}  // namespace deltadyn
