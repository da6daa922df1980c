#include "../../src/identification/fit_metric.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <gtest/gtest.h>

#include "deltadyn/runtime/random.hpp"

#include "../../src/identification/fit_convex.hpp"
#include "identification/fit_problems.hpp"

namespace deltadyn::fit {
namespace {

using testing_support::random_problem;

/// Fitted entries of a consistent body away from the anchor, by moving its variables.
Eigen::VectorXd moved(const Block& block, double spread, unsigned seed) {
  std::mt19937 random(seed);
  NormalDistribution normal;
  Eigen::VectorXd y(block.fitted());
  if (!block.is_body()) return Eigen::VectorXd::Constant(1, block.anchor(0) * std::exp(spread * normal(random)));
  LogCholeskyVector<double> pi = block.pi;
  for (const int variable : block.variables) pi(variable) += spread * normal(random);
  const InertialVector<double> p = from_log_cholesky(pi);
  for (int i = 0; i < block.fitted(); ++i) y(i) = p(block.entries[static_cast<std::size_t>(i)]);
  return y;
}

struct Case {
  ParameterSet set;
  FitMetric metric;
};
class FitMetricCases : public ::testing::TestWithParam<Case> {};

TEST_P(FitMetricCases, JacobianAgreesWithExtrapolatedDifferences) {
  const FitMetric metric = GetParam().metric;  // no structured binding: clang 14 cannot capture one in a lambda
  const Layout layout = make_layout(random_problem(1, 37, 1e3, 1, true), GetParam().set);
  for (const Block& block : layout.blocks) {
    for (const double spread : {0.0, 1e-4, 1e-2, 0.3}) {  // equal eigenvalues, the series, and the closed form
      const Eigen::VectorXd y = moved(block, spread, 2);
      Eigen::VectorXd residual(residual_size(block, metric)), above = residual, below = residual;
      Eigen::MatrixXd J;
      ASSERT_TRUE(metric_residual(block, layout, metric, y, residual, &J)) << block.name;
      for (int k = 0; k < block.fitted(); ++k) {
        // a step against the room inside the cone, which thin bodies have little of
        double size = 1;
        if (block.metric.size > 0) {
          const int n = block.metric.size;
          const Eigen::Matrix4d& C = block.metric_root;
          size = 1 / (C.transpose() * block.metric.basis[static_cast<std::size_t>(k)] * C).topLeftCorner(n, n).norm();
        } else {
          size = layout.scale(block.column + block.entries[static_cast<std::size_t>(k)]);
        }
        const auto central = [&](double step) -> Eigen::VectorXd {
          EXPECT_TRUE(
              metric_residual(block, layout, metric, y + step * Eigen::VectorXd::Unit(y.size(), k), above, nullptr));
          EXPECT_TRUE(
              metric_residual(block, layout, metric, y - step * Eigen::VectorXd::Unit(y.size(), k), below, nullptr));
          return (above - below) / (2 * step);
        };
        // Richardson: near a small eigenvalue the truncation of plain central differences exceeds the tolerance
        const Eigen::VectorXd numeric = (4 * central(0.5e-5 * size) - central(1e-5 * size)) / 3;
        EXPECT_LT((numeric - J.col(k)).norm() * size, 1e-5 * (1 + J.col(k).norm() * size))
            << block.name << " " << k << " " << spread;
      }
    }
  }
}

TEST_P(FitMetricCases, TermsAreTheSumOfSquaresAndItsGradient) {
  const auto [set, metric] = GetParam();
  const Layout layout = make_layout(random_problem(3, 37, 1e3, 1, true), set);
  for (const Block& block : layout.blocks) {
    const Eigen::VectorXd y = moved(block, 0.2, 4);
    Eigen::VectorXd residual(residual_size(block, metric)), gradient;
    Eigen::MatrixXd J, hessian;
    double value = 0;
    ASSERT_TRUE(metric_residual(block, layout, metric, y, residual, &J));
    ASSERT_TRUE(metric_terms(block, layout, metric, y, value, &gradient, &hessian));
    EXPECT_NEAR(value, residual.squaredNorm(), 1e-8 * (1 + value)) << block.name;
    EXPECT_LT((gradient - 2 * J.transpose() * residual).norm(), 1e-6 * (1 + gradient.norm())) << block.name;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(hessian).eigenvalues()(0), 0.0) << block.name;
  }
}

INSTANTIATE_TEST_SUITE_P(
    SetsAndMetrics, FitMetricCases,
    ::testing::Values(Case{ParameterSet::reduced, FitMetric::relative}, Case{ParameterSet::reduced, FitMetric::bregman},
                      Case{ParameterSet::reduced, FitMetric::riemannian}, Case{ParameterSet::full, FitMetric::relative},
                      Case{ParameterSet::full, FitMetric::bregman}, Case{ParameterSet::full, FitMetric::riemannian}));

/// Problem with layout and solver, in the form the fit uses.
struct Prepared {
  ConsistentFitProblem problem;
  Layout layout;
  Eigen::MatrixXd A;
  ConvexProblem convex;

  Prepared(const ConsistentFitProblem& from, ParameterSet set)
      : problem(from), layout(make_layout(problem, set)), A(fitted_columns()), convex(layout, square(), rhs()) {}
  Eigen::MatrixXd fitted_columns() const {
    Eigen::MatrixXd columns(problem.A.rows(), layout.fitted);
    for (int i = 0; i < layout.fitted; ++i) columns.col(i) = problem.A.col(layout.y_to_p[static_cast<std::size_t>(i)]);
    return columns;
  }
  Eigen::MatrixXd square() const {
    return Eigen::HouseholderQR<Eigen::MatrixXd>(A)
        .matrixQR()
        .topRows(layout.fitted)
        .triangularView<Eigen::Upper>()
        .toDenseMatrix();
  }
  Eigen::VectorXd rhs() const {
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(A);
    return (qr.householderQ().transpose() * problem.b).head(layout.fitted);
  }
};

TEST(ConvexFit, TwoStartsMeetAndTheGapNeverUnderstatesTheDistance) {
  for (const ParameterSet set : {ParameterSet::reduced, ParameterSet::full}) {
    const Prepared prepared(random_problem(5, 37, 100, 0.8, true), set);
    for (const FitMetric metric : {FitMetric::relative, FitMetric::bregman}) {
      const double lambda = 0.5;
      const Eigen::VectorXd start = convex_start(prepared.layout);
      const ConvexProblem::Result first = prepared.convex.minimise(metric, lambda, start);
      const ConvexProblem::Result second = prepared.convex.minimise(metric, lambda, 3 * start);  // a cone: still inside
      ASSERT_TRUE(first.converged && second.converged);
      const Eigen::VectorXd best = first.x.head(prepared.layout.fitted);
      const double lowest = prepared.convex.cost(metric, lambda, best);
      EXPECT_NEAR(prepared.convex.cost(metric, lambda, second.x.head(best.size())), lowest, 0.01);
      EXPECT_LT(prepared.convex.certify(metric, lambda, best).gap, 0.01);
      int finite = 0;
      for (unsigned seed = 0; seed < 40; ++seed) {
        Eigen::VectorXd other(best.size());
        for (const Block& block : prepared.layout.blocks)
          other.segment(block.y, block.fitted()) = moved(block, 0.3, seed);
        const double share = std::pow(10.0, -0.2 * seed);
        const Eigen::VectorXd y = best + share * (other - best);
        const OptimalityCertificate certificate = prepared.convex.certify(metric, lambda, y);
        const double distance = prepared.convex.cost(metric, lambda, y) - lowest;
        EXPECT_GE(certificate.gap, distance - 1e-6 * (1 + distance));
        finite += std::isfinite(certificate.gap) ? 1 : 0;
      }
      EXPECT_GT(finite, 5);
      EXPECT_GT(prepared.convex.certify(metric, lambda, start.head(best.size())).gap, 1.0)
          << "a point far off must not pass";
    }
  }
}

TEST(SplitInertia, UsesUpTheMass) {
  for (const auto& [a, b] : {std::pair{0.09, 0.009}, {0.009, -0.09}, {0.05, 0.05}, {-0.1, 0.0}, {0.0, 0.1}}) {
    const double mass = 1.0, inertia = 0.19, Sa = split_inertia(mass, a, b, inertia), Sb = inertia - Sa;
    EXPECT_GE(Sa, 0.0);
    EXPECT_GE(Sb, 0.0);
    const double used = (a != 0 ? a * a / Sa : 0.0) + (b != 0 ? b * b / Sb : 0.0);
    EXPECT_NEAR(used, mass, 1e-12);
  }
}

}  // namespace
}  // namespace deltadyn::fit
