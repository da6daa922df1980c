#include "deltadyn/excitation/predicted_uncertainty.hpp"

#include <Eigen/QR>
#include <cmath>
#include <gmock/gmock.h>
#include <random>

#include "deltadyn/excitation/optimize.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/random.hpp"

#include "excitation/excitation_setup.hpp"

namespace deltadyn {
namespace {

using testing_support::excitation_setup;
using testing_support::ExcitationSetup;

TrajectorySamples samples_of(const ExcitationSetup& setup, Eigen::Index count) {
  ExcitationOptions options;
  options.harmonics = 3;
  const FourierSeries series = random_feasible_series(setup.space, *setup.limits, options, 4);
  TrajectorySamples samples;
  samples.t_s = Eigen::VectorXd::LinSpaced(count, 0, 2);
  const Eigen::VectorXd phases = series.omega() * samples.t_s;
  samples.z = series.at_phases(phases, 0);
  samples.zd = series.at_phases(phases, 1);
  samples.zdd = series.at_phases(phases, 2);
  complete_drives(*setup.robot, samples);
  return samples;
}

// The scatter of least-squares estimates from many noisy logs.
TEST(PredictedUncertainty, IsTheScatterOfEstimates) {
  const ExcitationSetup setup = excitation_setup("axis", 300);
  const TrajectorySamples samples = samples_of(setup, 100);
  const auto p = static_cast<Eigen::Index>(setup.space.base_columns.size());
  const Eigen::VectorXd noise = Eigen::VectorXd::Constant(1, 0.3);
  const Eigen::VectorXd predicted = predicted_std(*setup.robot, setup.space.base_columns, samples, noise);
  Eigen::MatrixXd A(100, p), Y(1, setup.robot->parameters());
  for (Eigen::Index i = 0; i < 100; ++i) {
    ASSERT_EQ(setup.robot->regressor(samples.q.row(i), samples.qd.row(i), samples.qdd.row(i), Y), Status::ok);
    for (Eigen::Index k = 0; k < p; ++k) A(i, k) = Y(0, setup.space.base_columns[static_cast<std::size_t>(k)]);
  }
  const Eigen::MatrixXd pseudo = A.completeOrthogonalDecomposition().pseudoInverse();
  std::mt19937_64 random(1);
  NormalDistribution normal(0, 0.3);
  constexpr int kLogs = 4000;
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(p);
  for (int log = 0; log < kLogs; ++log) {
    Eigen::VectorXd error(100);
    for (Eigen::Index i = 0; i < 100; ++i) error(i) = normal(random);
    squares += (pseudo * error).cwiseAbs2();
  }
  const Eigen::VectorXd scatter = (squares / kLogs).cwiseSqrt();
  for (Eigen::Index k = 0; k < p; ++k) EXPECT_NEAR(predicted(k) / scatter(k), 1, 0.06);
}

TEST(PredictedUncertainty, ScalesWithNoiseAndIsInfiniteWithoutMotion) {
  const ExcitationSetup setup = excitation_setup("delta3", 300);
  TrajectorySamples samples = samples_of(setup, 200);
  const Eigen::VectorXd noise = Eigen::VectorXd::Constant(3, 0.1);
  const auto& columns = setup.space.base_columns;
  const Eigen::VectorXd once = predicted_std(*setup.robot, columns, samples, noise);
  const Eigen::VectorXd twice = predicted_std(*setup.robot, columns, samples, 2 * noise);
  EXPECT_LT((twice - 2 * once).cwiseAbs().maxCoeff(), 1e-9 * once.maxCoeff());
  samples.qd.setZero();
  samples.qdd.setZero();
  EXPECT_TRUE(std::isinf(predicted_std(*setup.robot, columns, samples, noise).maxCoeff()))
      << "no friction shows at rest";
  EXPECT_THROW((void)predicted_std(*setup.robot, columns, samples, Eigen::VectorXd::Zero(3)), Error);
  EXPECT_THROW((void)predicted_std(*setup.robot, columns, samples, noise, 0), Error);
}

}  // namespace
}  // namespace deltadyn
