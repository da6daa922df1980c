#include "deltadyn/identification/consistent_fit.hpp"

#include <Eigen/SVD>
#include <cmath>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "deltadyn/model/log_cholesky.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/random.hpp"

#include "identification/fit_problems.hpp"

namespace deltadyn {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing_support::body_of;
using testing_support::lifted_robot;
using testing_support::random_problem;

constexpr int kBodies = 6, kRank = 37;

ConsistentFitOptions make_options(ParameterSet set, FitMetric metric) {
  ConsistentFitOptions options;
  options.set = set;
  options.metric = metric;
  return options;
}

void expect_consistent(const ConsistentFitSummary& summary) {
  for (int body = 0; body < kBodies; ++body) {
    EXPECT_TRUE(is_physically_consistent(body_of(summary.p, body)))
        << owner_name(summary.parameters[static_cast<std::size_t>(10 * body)]);
  }
  EXPECT_GT(summary.p.tail(summary.p.size() - 10 * kBodies).minCoeff(), 0.0);
}

int index_of(const ConsistentFitSummary& summary, const std::string& name) {
  return static_cast<int>(std::find(summary.parameters.begin(), summary.parameters.end(), parameter_id(name)) -
                          summary.parameters.begin());
}

struct Case {
  ParameterSet set;
  FitMetric metric;
};

class ConsistentFitCases : public ::testing::TestWithParam<Case> {};

TEST_P(ConsistentFitCases, DataDecideWhatTheySeeWhateverThePrior) {
  const auto [set, metric] = GetParam();
  const bool reduced = set == ParameterSet::reduced;
  for (const unsigned seed : {1U, 2U, 3U}) {
    const ConsistentFitProblem low = random_problem(seed, kRank, 1e4, 0.7, reduced);
    const ConsistentFitProblem high = random_problem(seed, kRank, 1e4, 1.3, reduced);
    const Eigen::VectorXd truth = low.prior / 0.7;
    const ConsistentFitOptions options = make_options(set, metric);
    const ConsistentFitSummary from_low = fit_consistent_parameters(low, options);
    const ConsistentFitSummary from_high = fit_consistent_parameters(high, options);
    EXPECT_LT((low.A * (from_low.p - from_high.p)).squaredNorm(),
              4 * (options.kDataMisfitRise + options.kCertificateGap));
    // the smallest chi^2 on the consistent set is a property of the data: it is the reference of the choice of lambda
    const ConsistentFitOptions convex = make_options(set, FitMetric::relative);
    const double minimum = fit_consistent_parameters(low, convex).data_cost_min;
    EXPECT_NEAR(from_low.data_cost_min, minimum, options.kCertificateGap);
    EXPECT_NEAR(from_high.data_cost_min, minimum, options.kCertificateGap);
    for (const ConsistentFitSummary* summary : {&from_low, &from_high}) {
      EXPECT_TRUE(summary->converged) << summary->brief_report();
      expect_consistent(*summary);
      // chi^2 with at most kRank degrees of freedom, six standard deviations
      EXPECT_LT((low.A * (summary->p - truth)).squaredNorm(), kRank + 6 * std::sqrt(2.0 * kRank));
      EXPECT_NEAR(summary->data_cost, (low.A * summary->p - low.b).squaredNorm(), 1e-6 * summary->data_cost);
      EXPECT_LT(summary->data_cost, summary->initial_data_cost);
      EXPECT_LE(summary->data_cost, summary->data_cost_min + options.kDataMisfitRise + options.kCertificateGap);
      EXPECT_EQ(summary->certificate.passed, metric != FitMetric::riemannian) << summary->brief_report();
    }
  }
}

TEST_P(ConsistentFitCases, StaysConsistentWherePlainLeastSquaresDoesNot) {
  const auto [set, metric] = GetParam();
  int inconsistent = 0;
  for (unsigned seed = 10; seed < 16; ++seed) {
    const ConsistentFitProblem problem = random_problem(seed, 60, 20, 0.8, set == ParameterSet::reduced);
    const Eigen::VectorXd plain =
        problem.prior + Eigen::BDCSVD<Eigen::MatrixXd>(problem.A, Eigen::ComputeThinU | Eigen::ComputeThinV)
                            .setThreshold(1e-10)
                            .solve(problem.b - problem.A * problem.prior);
    for (int body = 0; body < kBodies; ++body) inconsistent += is_physically_consistent(body_of(plain, body)) ? 0 : 1;
    const ConsistentFitSummary summary = fit_consistent_parameters(problem, make_options(set, metric));
    expect_consistent(summary);
    EXPECT_EQ(summary.certificate.passed, metric != FitMetric::riemannian) << summary.brief_report();
  }
  EXPECT_GT(inconsistent, 6) << "the test must be a hard one";
}

TEST_P(ConsistentFitCases, VariablesGiveTheParameters) {
  const auto [set, metric] = GetParam();
  const ConsistentFitSummary summary = fit_consistent_parameters(
      random_problem(20, kRank, 1e3, 1.2, set == ParameterSet::reduced), make_options(set, metric));
  for (int body = 0; body < kBodies; ++body) {
    const InertialVector<double> p = body_of(summary.p, body);
    const LogCholeskyVector<double> pi = summary.pi.segment<10>(10 * body);
    EXPECT_LT((from_log_cholesky(pi) - p).norm(), 1e-9 * p.norm()) << "body " << body;
  }
  for (Eigen::Index i = 10 * kBodies; i < summary.p.size(); ++i)
    EXPECT_NEAR(std::exp(summary.pi(i)), summary.p(i), 1e-9 * summary.p(i));
}

INSTANTIATE_TEST_SUITE_P(
    SetsAndMetrics, ConsistentFitCases,
    ::testing::Values(Case{ParameterSet::reduced, FitMetric::relative}, Case{ParameterSet::reduced, FitMetric::bregman},
                      Case{ParameterSet::reduced, FitMetric::riemannian}, Case{ParameterSet::full, FitMetric::relative},
                      Case{ParameterSet::full, FitMetric::bregman}, Case{ParameterSet::full, FitMetric::riemannian}));

TEST(ConsistentFit, NoFeasiblePointIsLower) {
  // J written out once more, for the relative metric and the full set; the problem is convex, so that a segment from p
  // to any consistent point must not go down.
  const ConsistentFitProblem problem = random_problem(30, kRank, 100, 0.8, false);
  ConsistentFitOptions options = make_options(ParameterSet::full, FitMetric::relative);
  options.regularization = 0.5;
  const ConsistentFitSummary summary = fit_consistent_parameters(problem, options);
  ASSERT_TRUE(summary.certificate.passed) << summary.brief_report();
  Eigen::VectorXd scale(problem.prior.size());
  for (Eigen::Index i = 0; i < scale.size(); ++i) scale(i) = std::abs(problem.prior(i));
  for (int body = 0; body < kBodies; ++body) {
    const PseudoInertia<double> M = to_pseudo_inertia(body_of(problem.prior, body));
    const double slender = 0.01 * M.topLeftCorner<3, 3>().trace();
    const double natural[10] = {M(3, 3),
                                std::sqrt(M(0, 0) * M(3, 3)),
                                std::sqrt(M(1, 1) * M(3, 3)),
                                std::sqrt(M(2, 2) * M(3, 3)),
                                slender,
                                slender,
                                slender,
                                std::sqrt(M(0, 0) * M(1, 1)),
                                std::sqrt(M(1, 1) * M(2, 2)),
                                std::sqrt(M(0, 0) * M(2, 2))};
    for (int k = 0; k < 10; ++k) {
      if (scale(10 * body + k) == 0) scale(10 * body + k) = natural[k];
    }
  }
  auto cost = [&](const Eigen::VectorXd& p) {
    return (problem.A * p - problem.b).squaredNorm() + 0.5 * (p - problem.prior).cwiseQuotient(scale).squaredNorm();
  };
  const double best = cost(summary.p);
  EXPECT_NEAR(best, summary.data_cost + summary.lambda * summary.regularization_cost, 1e-8 * best);
  std::mt19937 random(31);
  NormalDistribution normal;
  for (int trial = 0; trial < 3000; ++trial) {
    const double spread = std::pow(10.0, -4.0 * (trial % 5) / 4.0);
    Eigen::VectorXd other = summary.p;
    for (int body = 0; body < kBodies; ++body) {
      LogCholeskyVector<double> pi = summary.pi.segment<10>(10 * body);
      for (int k = 0; k < 10; ++k) pi(k) += spread * normal(random);
      other.segment<10>(10 * body) = from_log_cholesky(pi);
    }
    for (Eigen::Index i = 10 * kBodies; i < other.size(); ++i) other(i) *= std::exp(spread * normal(random));
    for (const double step : {1.0, 1e-2, 1e-4}) {
      EXPECT_GE(cost(summary.p + step * (other - summary.p)), best - summary.certificate.gap - 1e-9 * best);
    }
  }
}

TEST(ConsistentFit, IsProvenHoweverSharpTheDataAndHoweverThinTheBodiesEnd) {
  for (const ParameterSet set : {ParameterSet::reduced, ParameterSet::full}) {
    for (const double precision : {20.0, 1e4, 1e6, 1e9}) {  // the last ones as logs without noise give them
      for (const int rank : {20, kRank, 60}) {
        const ConsistentFitProblem problem = random_problem(101, rank, precision, 0.7, set == ParameterSet::reduced);
        const ConsistentFitSummary summary = fit_consistent_parameters(problem, make_options(set, FitMetric::relative));
        EXPECT_TRUE(summary.converged && summary.certificate.passed)
            << "precision " << precision << ", rank " << rank << "\n"
            << summary.brief_report();
      }
    }
  }
}

TEST(ConsistentFit, IsProvenWhereAForceLiftsMoreThanTheRobotWeighs) {
  // The least chi^2 then lies where the boundary of what bodies can have bends most, far from the prior.
  for (const Eigen::Vector3d& tilts : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.4, -0.3, 0.2)}) {
    for (const double lift : {10.0, 50.0, 100.0}) {
      for (const unsigned seed : {1U, 2U, 3U}) {
        ConsistentFitOptions options;
        options.regularization = 0.1;
        const ConsistentFitSummary summary = fit_consistent_parameters(lifted_robot(seed, tilts, lift), options);
        EXPECT_TRUE(summary.converged && summary.certificate.passed)
            << "tilts " << tilts.transpose() << ", lift " << lift << " N, seed " << seed << "\n"
            << summary.brief_report();
        EXPECT_LT(summary.interior_point_iterations, 400) << "a cut that was too deep is taken back";
      }
    }
  }
}

TEST(ConsistentFit, IsProvenFromBodiesNextToTheBoundary) {
  // What a fit without the force made of the bodies is the prior of the fit that knows it.
  for (const double lift : {10.0, 50.0}) {
    for (const unsigned seed : {1U, 2U, 3U}) {
      const Eigen::Vector3d tilts(0.4, -0.3, 0.2);
      ConsistentFitOptions options;
      options.regularization = 1e-3;
      ConsistentFitProblem problem = lifted_robot(seed, tilts, 0);
      problem.prior = fit_consistent_parameters(lifted_robot(seed, tilts, lift), options).p;
      options.regularization = 1e-6;
      const ConsistentFitSummary summary = fit_consistent_parameters(problem, options);
      EXPECT_TRUE(summary.converged && summary.certificate.passed) << "lift " << lift << " N, seed " << seed << "\n"
                                                                   << summary.brief_report();
      EXPECT_LT(summary.interior_point_iterations, 150) << "lift " << lift << " N, seed " << seed;
      EXPECT_LT(summary.data_cost, 1e-3) << "the logs have no noise";
    }
  }
}

TEST(ConsistentFit, LeastSquaresIsTheFloorOfChiSquare) {
  const ConsistentFitProblem problem = random_problem(33, kRank, 1e3, 0.8, false);
  ConsistentFitOptions options = make_options(ParameterSet::full, FitMetric::relative);
  const ConsistentFitSummary summary = fit_consistent_parameters(problem, options);
  const Eigen::VectorXd plain = Eigen::BDCSVD<Eigen::MatrixXd>(problem.A, Eigen::ComputeThinU | Eigen::ComputeThinV)
                                    .setThreshold(1e-10)
                                    .solve(problem.b);
  EXPECT_EQ(summary.data_rank, kRank);
  EXPECT_NEAR(summary.data_cost_free, (problem.A * plain - problem.b).squaredNorm(), 1e-6);
  EXPECT_LE(summary.data_cost_free, summary.data_cost + 1e-9);
  EXPECT_TRUE(summary.agrees_with_least_squares());
  options.regularization = 1e9;
  EXPECT_FALSE(fit_consistent_parameters(problem, options).agrees_with_least_squares());
}

TEST(ConsistentFit, VariableCounts) {
  const ConsistentFitProblem problem = random_problem(40, kRank, 1e3, 1.1, true);
  EXPECT_EQ(fit_consistent_parameters(problem, make_options(ParameterSet::reduced, FitMetric::relative)).variables, 36);
  EXPECT_EQ(fit_consistent_parameters(problem, make_options(ParameterSet::full, FitMetric::relative)).variables, 71);
}

TEST(ConsistentFit, ReducedSetHoldsItsZeros) {
  const ConsistentFitSummary summary = fit_consistent_parameters(random_problem(41, kRank, 1e3, 1.1, true));
  for (const char* name : {"strut.mcy", "strut.mcz", "strut.Ixy", "strut.Iyz", "strut.Ixz", "telescope_upper.mcx",
                           "telescope_lower.mcy", "upper_arm.mcy", "tool.Ixy"}) {
    EXPECT_EQ(summary.p(index_of(summary, name)), 0.0) << name;
    EXPECT_EQ(summary.data_share(index_of(summary, name)), 0.0) << name;
    EXPECT_FALSE(summary.fitted[static_cast<std::size_t>(index_of(summary, name))]) << name;
  }
}

TEST(ConsistentFit, DroppedEntriesKeepThePrior) {
  ConsistentFitProblem problem = random_problem(42, kRank, 1e4, 1.02, true);
  const ConsistentFitSummary summary = fit_consistent_parameters(problem);
  for (const char* name : {"tool.mcz", "platform.Izz", "upper_arm.Ixx", "upper_arm.Izz"}) {
    const int i = index_of(summary, name);
    EXPECT_NEAR(summary.p(i), problem.prior(i), 1e-12) << name;
  }
}

TEST(ConsistentFit, DroppedInertiasFollowTheFittedOne) {
  const ConsistentFitProblem problem = random_problem(42, kRank, 1e4, 1.3, true);
  const ConsistentFitSummary summary = fit_consistent_parameters(problem);
  const int Ixx = index_of(summary, "upper_arm.Ixx"), Iyy = index_of(summary, "upper_arm.Iyy");
  EXPECT_NEAR(summary.p(Ixx) / summary.p(Iyy), problem.prior(Ixx) / problem.prior(Iyy), 1e-9);
}

TEST(ConsistentFit, ZeroAndThinPriors) {
  ConsistentFitProblem problem = random_problem(43, kRank, 1e4, 0.9, true);
  const Eigen::VectorXd truth = problem.prior / 0.9;
  problem.prior.tail(11).setZero();                                            // nothing known about friction and rotor
  problem.prior.segment<9>(21).setZero();                                      // platform: a mass and nothing else
  problem.prior.segment<10>(10) << 0.25, 0.129, 0, 0, 0, 0.11, 0.11, 0, 0, 0;  // strut: an ideal rod
  for (const FitMetric metric : {FitMetric::relative, FitMetric::bregman, FitMetric::riemannian}) {
    const ConsistentFitSummary summary =
        fit_consistent_parameters(problem, make_options(ParameterSet::reduced, metric));
    EXPECT_TRUE(summary.converged) << summary.brief_report();
    expect_consistent(summary);
    EXPECT_TRUE(summary.std.allFinite() && summary.data_share.allFinite() && summary.p.allFinite());
    EXPECT_LT((problem.A * (summary.p - truth)).squaredNorm(), kRank + 6 * std::sqrt(2.0 * kRank));
    EXPECT_THAT(summary.notes, Contains(HasSubstr("the prior of strut was on the boundary")));
  }
  const ConsistentFitSummary full =
      fit_consistent_parameters(problem, make_options(ParameterSet::full, FitMetric::relative));
  expect_consistent(full);
  EXPECT_TRUE(full.certificate.passed) << full.brief_report();
}

TEST(ConsistentFit, FrictionThatTheDataDenyGoesToZeroAndStaysPositive) {
  ConsistentFitProblem problem = random_problem(44, kRank, 1e4, 1, true);
  const int viscous = index_of(fit_consistent_parameters(problem), "drive1.viscous");
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(problem.A.rows() + 1, problem.A.cols());
  A.topRows(problem.A.rows()) = problem.A;
  A.col(viscous).setZero();
  A(problem.A.rows(), viscous) = 1e3;
  Eigen::VectorXd b(problem.b.size() + 1);
  // -0.05 N m s/rad, fifty standard deviations below 0
  b << problem.b - problem.A.col(viscous) * problem.prior(viscous), -50;
  problem.A = A;
  problem.b = b;
  const ConsistentFitSummary summary = fit_consistent_parameters(problem);
  EXPECT_GT(summary.p(viscous), 0.0);
  EXPECT_LT(summary.p(viscous), 1e-5);
  EXPECT_TRUE(summary.certificate.passed) << summary.brief_report();
}

TEST(ConsistentFit, OffsetHasNoSignAndCarriageIsAMass) {
  // a screw axis: F = m a + Fv v + Fc sign(v) + offset
  std::mt19937 random(45);
  NormalDistribution normal;
  const int rows = 400;
  ConsistentFitProblem problem;
  for (int k = 0; k < kInertialParameters; ++k)
    problem.parameters.push_back({ParameterKind::inertial, 0, Body::upper_arm, k});
  for (const ParameterKind kind : {ParameterKind::viscous, ParameterKind::coulomb, ParameterKind::offset})
    problem.parameters.push_back({kind, 1});
  problem.A = Eigen::MatrixXd::Zero(rows, 13);
  problem.b.resize(rows);
  for (int i = 0; i < rows; ++i) {
    const double a = normal(random), v = 0.1 * normal(random);
    problem.A(i, 0) = a;
    problem.A(i, 10) = v;
    problem.A(i, 11) = v > 0 ? 1 : -1;
    problem.A(i, 12) = 1;
    problem.b(i) = 95 * a + 200 * v + 20 * (v > 0 ? 1 : -1) - 3 + 0.5 * normal(random);
  }
  problem.A /= 0.5;
  problem.b /= 0.5;
  problem.prior = Eigen::VectorXd::Zero(13);
  problem.prior(0) = 60;
  const ConsistentFitSummary summary = fit_consistent_parameters(problem);
  EXPECT_EQ(summary.variables, 4);
  const std::pair<int, double> expected[] = {{0, 95}, {10, 200}, {11, 20}, {12, -3}};
  for (const auto& [i, value] : expected) {
    EXPECT_NEAR(summary.p(i), value, 5 * summary.std(i))
        << parameter_name(problem.parameters[static_cast<std::size_t>(i)]);
    EXPECT_GT(summary.data_share(i), 0.99);
  }
  EXPECT_TRUE(is_physically_consistent<double>(summary.p.head<10>()));
  EXPECT_TRUE(summary.certificate.passed);
}

TEST(ConsistentFit, UncertaintyOfAScalarProblemByHand) {
  ConsistentFitProblem problem;
  problem.parameters = {{ParameterKind::viscous, 1}, {ParameterKind::coulomb, 1}};
  problem.A = Eigen::Vector2d(3.0, 0.0).asDiagonal();  // viscous seen with a standard deviation of 1/3, Coulomb unseen
  problem.b = Eigen::Vector2d(6.0, 0.0);
  problem.prior = Eigen::Vector2d(2.0, 5.0);
  problem.prior_std = Eigen::Vector2d(0.5, 1.0);
  const ConsistentFitSummary summary = fit_consistent_parameters(problem);
  EXPECT_NEAR(summary.std(0), 1 / std::sqrt(9.0 + 4.0), 1e-12);
  EXPECT_NEAR(summary.data_share(0), 9.0 / 13.0, 1e-12);
  EXPECT_NEAR(summary.std(1), 1.0, 1e-12);
  EXPECT_NEAR(summary.data_share(1), 0.0, 1e-12);
  EXPECT_NEAR(summary.p(0), 2.0, 1e-4);
  EXPECT_NEAR(summary.p(1), 5.0, 1e-4);
}

TEST(ConsistentFit, UnitsOfLengthDoNotMatter) {
  const ConsistentFitProblem metre = random_problem(46, kRank, 1e3, 0.8, false);
  ConsistentFitProblem millimetre = metre;
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(metre.prior.size());
  for (int body = 0; body < kBodies; ++body) {
    unit.segment<3>(10 * body + 1).setConstant(1e3);
    unit.segment<6>(10 * body + 4).setConstant(1e6);
  }
  millimetre.prior = metre.prior.cwiseProduct(unit);
  millimetre.A = metre.A * unit.cwiseInverse().asDiagonal();
  for (const FitMetric metric : {FitMetric::relative, FitMetric::bregman}) {
    ConsistentFitOptions options = make_options(ParameterSet::full, metric);
    options.regularization = 0.3;
    const Eigen::VectorXd in_metres = fit_consistent_parameters(metre, options).p;
    const Eigen::VectorXd in_millimetres = fit_consistent_parameters(millimetre, options).p.cwiseQuotient(unit);
    EXPECT_LT((metre.A * (in_metres - in_millimetres)).norm(), 0.05);
    EXPECT_LT((in_metres - in_millimetres).cwiseQuotient(metre.prior.cwiseAbs().cwiseMax(1e-2)).cwiseAbs().maxCoeff(),
              0.02);
  }
}

TEST(ConsistentFit, LargerLambdaFollowsThePriorMoreAndTheLCurveIsMonotone) {
  const ConsistentFitProblem problem = random_problem(47, kRank, 1e3, 0.7, true);
  const ConsistentFitSummary automatic = fit_consistent_parameters(problem);
  EXPECT_TRUE(automatic.lambda_from_data);
  ASSERT_GE(automatic.l_curve.size(), 4U);
  for (std::size_t i = 1; i < automatic.l_curve.size(); ++i) {
    EXPECT_LE(automatic.l_curve[i - 1].data_cost, automatic.l_curve[i].data_cost + 1e-3);
    EXPECT_GE(automatic.l_curve[i - 1].regularization_cost, automatic.l_curve[i].regularization_cost - 1e-3);
  }
  ConsistentFitOptions strong;
  strong.regularization = 1e9;
  const ConsistentFitSummary pulled = fit_consistent_parameters(problem, strong);
  EXPECT_FALSE(pulled.lambda_from_data);
  EXPECT_LT(pulled.regularization_cost, automatic.regularization_cost);
  EXPECT_GT(pulled.data_cost, automatic.data_cost);
}

TEST(ConsistentFit, IndividualLimbs) {
  const std::vector<double> strut = {0.278, 0.104, 0, 0, 0.0246, 0.114, 0.116, 0, 0, 0};
  ConsistentFitProblem problem;
  problem.prior.resize(30);
  for (int limb = 0; limb < 3; ++limb) {
    for (int k = 0; k < 10; ++k) {
      problem.parameters.push_back({ParameterKind::inertial, limb + 1, Body::strut, k});
      problem.prior(10 * limb + k) = strut[static_cast<std::size_t>(k)];
    }
  }
  problem.A = Eigen::MatrixXd::Zero(3, 30);
  for (int limb = 0; limb < 3; ++limb) problem.A(limb, 10 * limb) = 1e3;
  problem.b = Eigen::Vector3d(300, 280, 260);
  const ConsistentFitSummary summary = fit_consistent_parameters(problem);
  EXPECT_EQ(summary.variables, 15);
  for (int limb = 0; limb < 3; ++limb) EXPECT_NEAR(summary.p(10 * limb), problem.b(limb) / 1e3, 2e-3);
}

TEST(ConsistentFit, ThatConvergesNowhereTellsTheFirstCause) {
  ConsistentFitProblem problem = random_problem(52, kRank, 1e3, 1, true);
  problem.A *= 1e200;  // its squares are beyond any number
  try {
    (void)fit_consistent_parameters(problem);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::no_convergence);
    EXPECT_THAT(error.what(), HasSubstr("did not converge at a regularisation of 1.11111e-08"));
  }
}

// --- what is refused ---------------------------------------------------------------------------

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST(ConsistentFitRefuses, PriorsThatNoBodyCanHave) {
  struct Row {
    ParameterSet set;
    const char* name;
    double value;
    const char* body;
    const char* rule;
  };
  const Row rows[] = {
      {ParameterSet::reduced, "strut.m", -0.2, "'strut'", "mass -0.2 kg is negative"},
      {ParameterSet::full, "platform.m", -1, "'platform'", "negative"},
      {ParameterSet::reduced, "platform.m", 0, "'platform'", "not positive"},
      {ParameterSet::reduced, "strut.Izz", 0.2, "'strut'", "triangle inequality Ixx + Iyy >= Izz"},
      {ParameterSet::full, "strut.Ixx", 0.4, "'strut'", "triangle inequality Iyy + Izz >= Ixx"},
      {ParameterSet::reduced, "platform.Iyy", 0.4, "'platform'", "triangle inequality Ixx + Izz >= Iyy"},
      {ParameterSet::full, "telescope_lower.mcz", 0.6, "'telescope_lower'", "first moments are too large"},
      {ParameterSet::reduced, "telescope_lower.mcz", 0.6, "'telescope_lower'", "first moments are too large"},
      {ParameterSet::reduced, "upper_arm.mcx", 0.7, "'upper_arm'", "first moments are too large"},
      {ParameterSet::reduced, "upper_arm.m", 0, "'upper_arm'", "first moments but no mass"},
      {ParameterSet::full, "platform.Ixy", 0.05, "'platform'", "products of inertia"},
      {ParameterSet::reduced, "drive2.viscous", -0.1, "drive2.viscous", "negative"},
      {ParameterSet::reduced, "strut.mcx", std::numeric_limits<double>::quiet_NaN(), "strut.mcx",
       "not a finite number"},
  };
  for (const Row& row : rows) {
    ConsistentFitProblem problem = random_problem(50, kRank, 1e3, 1, true);
    const auto& ids = problem.parameters;
    problem.prior(std::find(ids.begin(), ids.end(), parameter_id(row.name)) - ids.begin()) = row.value;
    const std::string message =
        message_of([&] { (void)fit_consistent_parameters(problem, make_options(row.set, FitMetric::relative)); });
    EXPECT_THAT(message, HasSubstr(row.body)) << row.name;
    EXPECT_THAT(message, HasSubstr(row.rule)) << row.name;
    EXPECT_THAT(message, HasSubstr("mend:")) << row.name;
  }
}

TEST(ConsistentFitRefuses, SizesAndParametersThatDoNotFit) {
  const ConsistentFitProblem good = random_problem(51, kRank, 1e3, 1, true);
  struct Row {
    const char* what;
    std::function<void(ConsistentFitProblem&)> damage;
  };
  const Row rows[] = {
      {"no parameters", [](ConsistentFitProblem& p) { p.parameters.clear(); }},
      {"A", [](ConsistentFitProblem& p) { p.A.conservativeResize(Eigen::NoChange, 70); }},
      {"b", [](ConsistentFitProblem& p) { p.b.conservativeResize(5); }},
      {"prior", [](ConsistentFitProblem& p) { p.prior.conservativeResize(5); }},
      {"prior_std", [](ConsistentFitProblem& p) { p.prior_std.setOnes(5); }},
      {"drive1.viscous",
       [](ConsistentFitProblem& p) {
         p.prior_std.setZero(71);
         p.prior_std.head(60).setOnes();
       }},
      {"not finite", [](ConsistentFitProblem& p) { p.A(3, 4) = std::numeric_limits<double>::infinity(); }},
      {"'mcx' is not in its place", [](ConsistentFitProblem& p) { std::swap(p.parameters[11], p.parameters[12]); }},
  };
  for (const Row& row : rows) {
    ConsistentFitProblem problem = good;
    row.damage(problem);
    EXPECT_THAT(message_of([&] { (void)fit_consistent_parameters(problem); }), HasSubstr(row.what));
  }
}

TEST(ConsistentFitRefuses, OptionsOutOfRange) {
  const std::pair<const char*, std::function<void(ConsistentFitOptions&)>> rows[] = {
      {"regularization", [](ConsistentFitOptions& o) { o.regularization = 0.0; }},
      {"prior_relative_std",
       [](ConsistentFitOptions& o) { o.prior_relative_std = std::numeric_limits<double>::quiet_NaN(); }},
  };
  const ConsistentFitProblem problem = random_problem(52, kRank, 1e3, 1, true);
  for (const auto& [field, damage] : rows) {
    ConsistentFitOptions options;
    damage(options);
    EXPECT_THAT(message_of([&] { (void)fit_consistent_parameters(problem, options); }), HasSubstr(field));
  }
}

}  // namespace
}  // namespace deltadyn
