#include "deltadyn/identification/consistent_fit.hpp"

#include <algorithm>
#include <ceres/ceres.h>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <optional>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/error.hpp"

#include "fit_blocks.hpp"
#include "fit_convex.hpp"
#include "fit_metric.hpp"
#include "seconds_since.hpp"

namespace deltadyn {
namespace {

using fit::Block;
using fit::BlockKind;
using fit::ConvexProblem;
using fit::Layout;
using Clock = std::chrono::steady_clock;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Fitted entries of a block from its variables, with dy/dpi when asked for.
Eigen::VectorXd fitted_entries(const Block& block, const double* variables, Eigen::MatrixXd* jacobian) {
  if (!block.is_body()) {
    const bool positive = block.shape == BlockKind::positive;
    const double y = positive ? std::exp(variables[0]) : variables[0];
    if (jacobian != nullptr) *jacobian = Eigen::MatrixXd::Constant(1, 1, positive ? y : 1.0);
    return Eigen::VectorXd::Constant(1, y);
  }
  const LogCholeskyVector<double> pi = Eigen::Map<const LogCholeskyVector<double>>(variables);
  const InertialVector<double> p = from_log_cholesky(pi);
  if (jacobian != nullptr) *jacobian = log_cholesky_jacobian(pi)(block.entries, Eigen::all);
  return p(block.entries);
}

/// First term of (15): A y(pi) - b over all blocks at once.
class DataResidual final : public ceres::CostFunction {
 public:
  DataResidual(const Layout& layout, const Eigen::MatrixXd& A, const Eigen::VectorXd& b)
      : layout_(layout), A_(A), b_(b) {
    set_num_residuals(static_cast<int>(A.rows()));
    for (const Block& block : layout.blocks) mutable_parameter_block_sizes()->push_back(block.width());
  }

  bool Evaluate(double const* const* variables, double* residuals, double** jacobians) const override {
    Eigen::Map<Eigen::VectorXd> residual(residuals, A_.rows());
    residual = -b_;
    Eigen::MatrixXd J;
    for (std::size_t i = 0; i < layout_.blocks.size(); ++i) {
      const Block& block = layout_.blocks[i];
      const bool wanted = jacobians != nullptr && jacobians[i] != nullptr;
      const Eigen::VectorXd y = fitted_entries(block, variables[i], wanted ? &J : nullptr);
      const auto columns = A_.middleCols(block.y, block.fitted());
      residual.noalias() += columns * y;
      if (!wanted) continue;
      Eigen::Map<RowMajor>(jacobians[i], A_.rows(), block.width()).noalias() = columns * J;
    }
    return residual.allFinite();
  }

 private:
  const Layout& layout_;
  const Eigen::MatrixXd& A_;
  const Eigen::VectorXd& b_;
};

/// Second term of (15) for one block: sqrt(lambda) times the residual of the metric.
class RegularizationResidual final : public ceres::CostFunction {
 public:
  RegularizationResidual(const Layout& layout, const Block& block, FitMetric metric, double lambda)
      : layout_(layout), block_(block), metric_(metric), weight_(std::sqrt(lambda)) {
    set_num_residuals(fit::residual_size(block, metric));
    mutable_parameter_block_sizes()->push_back(block.width());
  }

  bool Evaluate(double const* const* variables, double* residuals, double** jacobians) const override {
    const bool wanted = jacobians != nullptr && jacobians[0] != nullptr;
    Eigen::MatrixXd dy_dpi, dr_dy;
    const Eigen::VectorXd y = fitted_entries(block_, variables[0], wanted ? &dy_dpi : nullptr);
    Eigen::Map<Eigen::VectorXd> residual(residuals, num_residuals());
    if (!fit::metric_residual(block_, layout_, metric_, y, residual, wanted ? &dr_dy : nullptr)) return false;
    residual *= weight_;
    if (wanted) Eigen::Map<RowMajor>(jacobians[0], num_residuals(), block_.width()) = weight_ * dr_dy * dy_dpi;
    return residual.allFinite();
  }

 private:
  const Layout& layout_;
  const Block& block_;
  FitMetric metric_;
  double weight_;
};

/// The variables of all blocks, in Ceres's hands.
using Variables = std::vector<LogCholeskyVector<double>>;

Eigen::VectorXd fitted_of(const Layout& layout, const Variables& variables) {
  Eigen::VectorXd y(layout.fitted);
  for (std::size_t i = 0; i < layout.blocks.size(); ++i) {
    const Block& block = layout.blocks[i];
    y.segment(block.y, block.fitted()) = fitted_entries(block, variables[i].data(), nullptr);
  }
  return y;
}

void solve_with_ceres(const Layout& layout, const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                      const ConsistentFitOptions& options, double lambda, Variables& variables,
                      ConsistentFitSummary& summary) {
  ceres::Problem problem;
  std::vector<double*> all;
  for (std::size_t i = 0; i < layout.blocks.size(); ++i) {
    const Block& block = layout.blocks[i];
    all.push_back(variables[i].data());
    std::vector<int> constant;
    for (int variable = 0; block.is_body() && variable < 10; ++variable) {
      if (std::find(block.variables.begin(), block.variables.end(), variable) == block.variables.end())
        constant.push_back(variable);
    }
    if (constant.empty()) {
      problem.AddParameterBlock(all.back(), block.width());
    } else {
      problem.AddParameterBlock(all.back(), block.width(), new ceres::SubsetManifold(block.width(), constant));
    }
    problem.AddResidualBlock(new RegularizationResidual(layout, block, options.metric, lambda), nullptr, all.back());
  }
  problem.AddResidualBlock(new DataResidual(layout, A, b), nullptr, all);

  ceres::Solver::Options solver;
  solver.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  solver.linear_solver_type = ceres::DENSE_QR;  // normal equations would lose the weakly excited directions
  solver.max_num_iterations = 200;
  solver.function_tolerance = 1e-8;  // relative change of J
  solver.gradient_tolerance = 1e-10;
  solver.parameter_tolerance = 1e-12;
  solver.logging_type = ceres::SILENT;
  solver.num_threads = 1;
  ceres::Solver::Summary result;
  ceres::Solve(solver, &problem, &result);
  summary.iterations = std::max(0, result.num_successful_steps + result.num_unsuccessful_steps - 1);
  summary.converged = result.termination_type == ceres::CONVERGENCE;
  summary.message = result.message;
}

void check_options(const ConsistentFitOptions& options) {
  const auto demand = [](double value, const char* what) {
    if (value > 0 && std::isfinite(value)) return;
    throw Error(what, "consistent fit, options", "see ConsistentFitOptions for the ranges", ExitCode::usage);
  };
  demand(options.regularization.value_or(1), "regularization must be a positive number or chosen from the data");
  demand(options.prior_relative_std, "prior_relative_std must be positive");
}

/// Where the search for lambda begins, as a share of the largest one.
constexpr double kSmallestLambda = 1e-9;

/// The largest lambda that costs the data no more than the admitted rise of chi^2.
double choose_lambda(const Layout& layout, const ConvexProblem& convex, const ConsistentFitOptions& options,
                     ConsistentFitSummary& summary) {
  const FitMetric metric = options.metric;
  const double highest =
      1 / (options.prior_relative_std * options.prior_relative_std);  // the prior is not trusted beyond its word
  double lowest = kSmallestLambda * highest;
  const Eigen::VectorXd start = fit::convex_start(layout);
  // Nothing where the fit does not converge.
  const auto solve = [&](FitMetric solved_metric, double lambda) -> std::optional<Eigen::VectorXd> {
    const ConvexProblem::Result result = convex.minimise(solved_metric, lambda, start);
    return result.converged ? std::optional<Eigen::VectorXd>(result.x.head(layout.fitted)) : std::nullopt;
  };
  const auto visit = [&](double lambda) -> std::optional<double> {
    const std::optional<Eigen::VectorXd> y = solve(metric, lambda);
    if (!y) return std::nullopt;
    summary.l_curve.push_back({lambda, convex.data_cost(*y), convex.regularization_cost(metric, *y)});
    return summary.l_curve.back().data_cost;
  };
  const auto refuse = [](double lambda) {
    throw Error(fmt::format("the fit did not converge at a regularisation of {:g}", lambda), "consistent fit",
                "give --regularization a value", ExitCode::no_convergence);
  };
  // Short logs leave directions that neither data nor prior hold at the smallest lambda: then begin at a larger one.
  std::optional<double> smallest = visit(lowest);
  for (; !smallest && 10 * lowest < highest; smallest = visit(lowest)) lowest *= 10;
  if (!smallest) smallest = visit(highest);
  if (!smallest) refuse(kSmallestLambda * highest);
  summary.data_cost_min = *smallest;
  if (lowest > 2 * kSmallestLambda * highest) {
    summary.notes.emplace_back("the logs hold some parameters so weakly that the prior must hold them");
  }
  // the minimum of chi^2 on the cones does not depend on the metric: take it where the problem is convex
  if (metric == FitMetric::riemannian) {
    const std::optional<Eigen::VectorXd> y = solve(FitMetric::relative, lowest);
    if (!y) refuse(lowest);
    summary.data_cost_min = convex.data_cost(*y);
  }
  const double limit = summary.data_cost_min + ConsistentFitOptions::kDataMisfitRise;
  double low = std::log(lowest), high = std::log(highest);
  double chosen = low;
  // Where the largest lambda does not converge, data and prior contradict each other: it costs more than is admitted.
  const std::optional<double> largest = visit(highest);
  if (largest && *largest <= limit) chosen = low = high;
  while (high - low > 0.1) {
    const double middle = 0.5 * (low + high);
    const std::optional<double> cost = visit(std::exp(middle));
    if (cost && *cost > limit) {
      high = middle;
    } else {
      low = middle;
      if (cost) chosen = middle;  // without convergence, look further up
    }
  }
  std::ranges::sort(summary.l_curve, {}, &LCurvePoint::lambda);
  return std::exp(chosen);
}

/// The best of three proofs for y: from its own gradient, and from the dual points of the centred solution next to it,
/// by gradient and by barrier. Where bodies end on the boundary, the latter bound the optimum more tightly than the
/// point where Ceres stops, which lies lower but is not centred.
/// \param centred  result of the convex solver with its splits, or empty
OptimalityCertificate certify(const ConvexProblem& convex, FitMetric metric, double lambda, const Eigen::VectorXd& y,
                              const Eigen::VectorXd& centred) {
  OptimalityCertificate best = convex.certify(metric, lambda, y);
  if (!best.available || centred.size() == 0) return best;
  const double cost = convex.cost(metric, lambda, y);
  const double cost_centred = convex.cost(metric, lambda, centred.head(y.size()));
  for (const Eigen::VectorXd& point : {Eigen::VectorXd(centred.head(y.size())), centred}) {
    OptimalityCertificate other = convex.certify(metric, lambda, point);
    other.gap = std::max(0.0, cost - (cost_centred - other.gap));
    if (other.available && other.gap < best.gap) best = other;
  }
  return best;
}

/// chi^2 of plain least squares and the number of parameters that the data see, columns in units of their scales.
void add_least_squares(const ConsistentFitProblem& problem, const Layout& layout, ConsistentFitSummary& summary) {
  const dense::PivotedQr qr(problem.A * layout.scale.asDiagonal());
  summary.data_rank = static_cast<int>(qr.rank());
  const Eigen::VectorXd rotated = qr.rotated(problem.b);
  summary.data_cost_free = rotated.tail(rotated.size() - summary.data_rank).squaredNorm();
}

/// Entries that section VI drops keep the prior's value where the data do not see them and the body stays consistent:
/// the mass matrix does not change, and a model handed to a simulator keeps what its maker knew. Where a fitted inertia
/// moved too far for that, the others move in proportion.
InertialVector<double> complete_body(const Block& block, const ConsistentFitProblem& problem, const Layout& layout,
                                     const InertialVector<double>& fitted) {
  const InertialVector<double> prior = problem.prior.segment<10>(block.column);
  if (block.shape == BlockKind::spatial || !is_physically_consistent(prior)) return fitted;
  const int measure = block.shape == BlockKind::planar ? block.inertia : inertial::kM;
  InertialVector<double> as_prior = fitted, in_proportion = fitted;
  for (int i = 0; i < 10; ++i) {
    const bool is_fitted = std::find(block.entries.begin(), block.entries.end(), i) != block.entries.end();
    const double seen = problem.A.col(block.column + i).norm() * layout.scale(block.column + i);
    if (is_fitted || seen > 1e-6) continue;  // in standard deviations of the noise
    as_prior(i) = prior(i);
    in_proportion(i) = prior(i) * fitted(measure) / prior(measure);
  }
  constexpr double kMargin = 1e-9;
  if (is_physically_consistent(as_prior, kMargin)) return as_prior;
  for (double share = 1; share > 1e-3; share *= 0.5) {
    const InertialVector<double> candidate = fitted + share * (in_proportion - fitted);
    if (is_physically_consistent(candidate, kMargin)) return candidate;
  }
  return fitted;
}

/// std and data_share of the fitted parameters, from the curvature of chi^2 and the prior's width. A prior that the
/// data moved by more than its width claimed too much: all its masses and inertias then count with a width larger by
/// the root mean square of these moves, and no parameter with less than its own.
void add_uncertainty(const ConsistentFitProblem& problem, const ConsistentFitOptions& options, const Layout& layout,
                     const Eigen::MatrixXd& A, ConsistentFitSummary& summary) {
  const int n = layout.fitted;
  summary.std =
      problem.prior_std.size() > 0 ? problem.prior_std : Eigen::VectorXd(options.prior_relative_std * layout.scale);
  summary.data_share = Eigen::VectorXd::Zero(layout.parameters);
  const Eigen::VectorXd move = (summary.p - problem.prior).cwiseAbs();
  double square = 0, inertial = 0;
  const auto is_inertial = [&problem](Eigen::Index parameter) {
    return problem.parameters[static_cast<std::size_t>(parameter)].kind == ParameterKind::inertial;
  };
  for (int i = 0; i < n; ++i) {
    const auto parameter = layout.y_to_p[static_cast<std::size_t>(i)];
    if (!is_inertial(parameter)) continue;
    square += std::pow(move(parameter) / summary.std(parameter), 2);
    inertial += 1;
  }
  const double widening = inertial > 0 ? std::max(1.0, std::sqrt(square / inertial)) : 1.0;
  for (Eigen::Index k = 0; k < summary.std.size(); ++k) {
    summary.std(k) = std::max(summary.std(k) * (is_inertial(k) ? widening : 1.0), move(k));
  }
  const Eigen::VectorXd prior_std = summary.std(layout.y_to_p);
  // in units of the prior's width: covariance = (A^T A + I)^{-1}, share = 1 - its diagonal
  Eigen::MatrixXd stacked(A.rows() + n, n);
  stacked << A * prior_std.asDiagonal(), Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd inverse =
      dense::solve_upper(dense::r_factor(stacked), Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n)));
  for (int i = 0; i < n; ++i) {
    const auto parameter = layout.y_to_p[static_cast<std::size_t>(i)];
    const double variance = inverse.row(i).squaredNorm();
    summary.std(parameter) = std::sqrt(variance) * prior_std(i);
    summary.data_share(parameter) = std::clamp(1 - variance, 0.0, 1.0);
  }
}

}  // namespace

bool ConsistentFitSummary::agrees_with_least_squares() const {
  const double expected = data_rank;
  return data_cost - data_cost_free <= expected + 3 * std::sqrt(2 * expected);
}

std::string ConsistentFitSummary::brief_report() const {
  const std::string proof = !certificate.available ? "no certificate for this metric"
                            : certificate.passed ? fmt::format("global optimum within {:.1e} of chi^2", certificate.gap)
                                                 : fmt::format("not proven optimal (gap {:.2e})", certificate.gap);
  return fmt::format(
      "consistent fit: {} variables, chi^2 {:.6g} (prior {:.3g}), lambda {:.3g}{}, {} after {} + {} iterations, {:.1f} "
      "ms, {}",
      variables, data_cost, initial_data_cost, lambda, lambda_from_data ? " from the data" : "",
      converged ? "converged" : "NOT converged", interior_point_iterations, iterations, 1e3 * solve_time_s, proof);
}

ConsistentFitSummary fit_consistent_parameters(const ConsistentFitProblem& problem,
                                               const ConsistentFitOptions& options) {
  const auto start_time = Clock::now();
  check_options(options);
  const Layout layout = fit::make_layout(problem, options.set);
  const int n = layout.fitted;
  ConsistentFitSummary summary;
  summary.parameters = problem.parameters;
  summary.prior = problem.prior;
  summary.notes = layout.notes;
  summary.variables = layout.variables;

  Eigen::MatrixXd A = problem.A(Eigen::all, layout.y_to_p);
  Eigen::VectorXd b = problem.b;
  double constant = 0;  // the part of b that no parameter reaches; kept apart, it would only cost digits
  if (A.rows() > n) {
    A.conservativeResize(Eigen::NoChange, n + 1);
    A.col(n) = b;
    const Eigen::MatrixXd R = dense::r_factor(A);
    A = R.topLeftCorner(n, n);
    b = R.col(n).head(n);
    constant = R(n, n) * R(n, n);
  }
  const ConvexProblem convex(layout, A, b);
  const Eigen::VectorXd start = fit::convex_start(layout);
  summary.initial_data_cost = constant + convex.data_cost(start.head(n));
  summary.lambda_from_data = !options.regularization.has_value();
  summary.lambda = options.regularization ? *options.regularization : choose_lambda(layout, convex, options, summary);

  const auto solve_time = Clock::now();
  Variables variables;
  for (const Block& block : layout.blocks) variables.push_back(block.pi);
  const ConvexProblem::Result inside = convex.minimise(options.metric, summary.lambda, start);
  summary.interior_point_iterations = inside.iterations;
  if (inside.x.size() > 0) {
    for (std::size_t i = 0; i < layout.blocks.size(); ++i) variables[i] = fit::variables_of(layout.blocks[i], inside.x);
  }
  solve_with_ceres(layout, A, b, options, summary.lambda, variables, summary);
  summary.solve_time_s = seconds_since(solve_time);

  const Eigen::VectorXd y = fitted_of(layout, variables);
  summary.data_cost = constant + convex.data_cost(y);
  summary.regularization_cost = convex.regularization_cost(options.metric, y);
  summary.data_cost_min = summary.lambda_from_data ? constant + summary.data_cost_min : summary.data_cost;
  for (LCurvePoint& point : summary.l_curve) point.data_cost += constant;
  summary.certificate = certify(convex, options.metric, summary.lambda, y, inside.x);
  summary.certificate.passed =
      summary.certificate.available && summary.certificate.gap <= ConsistentFitOptions::kCertificateGap;
  // Ceres measures its progress by the size of J, which rounding hides where J is next to nothing: the proof counts for
  // more.
  summary.converged = summary.converged || summary.certificate.passed;
  add_least_squares(problem, layout, summary);

  summary.p.resize(layout.parameters);
  summary.pi.resize(layout.parameters);
  summary.fitted.assign(static_cast<std::size_t>(layout.parameters), false);
  for (const int parameter : layout.y_to_p) summary.fitted[static_cast<std::size_t>(parameter)] = true;
  for (std::size_t i = 0; i < layout.blocks.size(); ++i) {
    const Block& block = layout.blocks[i];
    if (!block.is_body()) {
      summary.p(block.column) = y(block.y);
      summary.pi(block.column) = variables[i](0);
      continue;
    }
    const InertialVector<double> p = complete_body(block, problem, layout, from_log_cholesky(variables[i]));
    LogCholeskyVector<double> pi = variables[i];
    if (to_log_cholesky(p, pi) != Status::ok) {
      // the body is so thin that its digits do not show its volume; the variables of the solver still do
      summary.notes.push_back(fmt::format("{} ends on the boundary of what a body can have", block.name));
      pi = variables[i];
    }
    summary.p.segment<10>(block.column) = p;
    summary.pi.segment<10>(block.column) = pi;
  }
  add_uncertainty(problem, options, layout, A, summary);
  summary.total_time_s = seconds_since(start_time);
  return summary;
}

}  // namespace deltadyn
