#include "../../src/identification/least_squares.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/random.hpp"

#include "identification/synthetic_log.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

std::vector<DriveFold> folds(const Robot& robot, const SyntheticOptions& synthetic) {
  ProcessingOptions options;
  options.filter = false;
  return fold_log(robot, prepare_log(robot, synthetic_log(robot, delta_truth(robot), synthetic), options)).regular;
}

TEST(LeastSquares, FindsTheExactBaseParametersWithoutNoise) {
  for (const bool individual : {false, true}) {
    ParameterOptions options;
    options.individual_limbs = individual;
    const auto robot = make_robot(delta_description("delta4"), options);
    const BaseParameters base = find_base_parameters(*robot);
    SyntheticOptions synthetic;
    synthetic.base_frequency_hz = 0.5;
    const BaseEstimate estimate = estimate_base_parameters(base, folds(*robot, synthetic));
    const Eigen::VectorXd truth = base.B * delta_truth(*robot);
    EXPECT_LT((estimate.value - truth).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_GT(estimate.condition_number, 1);
  }
}

TEST(LeastSquares, NoiseLevelIsFoundDriveByDrive) {
  const auto robot = make_robot(delta_description("delta4"));
  SyntheticOptions synthetic;
  synthetic.torque_noise = 0.2;
  const BaseEstimate estimate = estimate_base_parameters(find_base_parameters(*robot), folds(*robot, synthetic));
  for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(estimate.noise[j].std, 0.2, 0.01);
  EXPECT_NEAR(estimate.noise[3].std, 0.02, 0.001);
}

TEST(LeastSquares, FurtherUncertaintyStandsInCovarianceAndFactorAlike) {
  const auto robot = make_robot(delta_description("delta4"));
  const BaseParameters base = find_base_parameters(*robot);
  SyntheticOptions synthetic;
  synthetic.torque_noise = 0.2;
  const BaseEstimate before = estimate_base_parameters(base, folds(*robot, synthetic));
  BaseEstimate after = before;
  // Along one direction nine times the variance is added, which makes ten of it.
  const Eigen::VectorXd direction = before.covariance.col(3) / std::sqrt(before.covariance(3, 3));
  add_uncertainty(base, 9 * direction * direction.transpose(), after);
  EXPECT_NEAR(after.covariance(3, 3), 10 * before.covariance(3, 3), 1e-6 * before.covariance(3, 3));
  EXPECT_EQ(after.value, before.value);
  // A p = b is solved by the estimate, with the covariance's inverse as information.
  const Eigen::VectorXd p = any_parameters(base, after.value, robot->parameters());
  EXPECT_LT((after.A * p - after.b).norm(), 1e-9 * after.b.norm());
  Eigen::MatrixXd A_B(after.A.rows(), base.count());
  for (int k = 0; k < base.count(); ++k) A_B.col(k) = after.A.col(base.independent[static_cast<std::size_t>(k)]);
  const Eigen::MatrixXd identity = A_B * after.covariance * A_B.transpose();
  EXPECT_NEAR(identity.trace(), base.count(), 1e-6 * base.count());
  EXPECT_NEAR(after.log_det, before.log_det - std::log(10.0), 1e-6);
}

TEST(LeastSquares, NamesWhatTheMotionDoesNotShow) {
  const auto robot = make_robot(delta_description("delta4"));
  ProcessingOptions options;
  options.filter = false;
  Log still = synthetic_log(*robot, delta_truth(*robot), SyntheticOptions{});
  still.qd.col(3).setZero();
  still.qdd.col(3).setZero();
  const auto rows = fold_log(*robot, prepare_log(*robot, still, options)).regular;
  try {
    (void)estimate_base_parameters(find_base_parameters(*robot), rows);
    FAIL() << "drive 4 never moves";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::not_trusted);
    EXPECT_THAT(e.what(), ::testing::HasSubstr("drive4."));
  }
}

TEST(NoiseCorrelation, WhiteNoiseIsOneAndCorrelatedNoiseHasItsKnownValue) {
  std::mt19937_64 random(5);
  NormalDistribution normal;
  const Eigen::Index N = 40000;
  const auto all = Eigen::Array<bool, Eigen::Dynamic, 1>::Constant(N, true).eval();
  Eigen::VectorXd white(N), correlated(N);
  double state = 0;
  for (Eigen::Index k = 0; k < N; ++k) {
    white(k) = normal(random);
    state = 0.8 * state + normal(random);
    correlated(k) = state;
  }
  EXPECT_EQ(noise_correlation(white, all, 50), 1.0);
  EXPECT_EQ(noise_correlation(white, all, 50, 1.05), 1.05);  // as good as white behind that filter
  EXPECT_NEAR(noise_correlation(white, all, 50, 2.0), 1.0, 0.2);
  EXPECT_NEAR(noise_correlation(correlated, all, 100), 1.8 / 0.2, 1.2);  // (1 + rho) / (1 - rho)
}

}  // namespace
}  // namespace deltadyn
