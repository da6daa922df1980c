#include "deltadyn/identification/base_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/workspace.hpp"

namespace deltadyn {

namespace {

constexpr double kNegligible = 1e-8;  // of a coefficient of B beside 1: rounding of the QR
constexpr double kVanishing = 1e-12;  // of a column beside the largest of its unit

Eigen::MatrixXd random_regressor(const Robot& robot, const BaseParameterOptions& options) {
  const int n = robot.drives();
  WorkspaceSampler sampler(robot, options.seed);
  Eigen::MatrixXd W(n * options.states, robot.parameters());
  Eigen::MatrixXd Y(n, robot.parameters());
  Eigen::VectorXd q, qd, qdd;
  for (int row = 0; row < options.states;) {
    sampler.next(q, qd, qdd);
    if (robot.regressor(q, qd, qdd, Y) != Status::ok) continue;
    W.middleRows(n * row, n) = Y;
    ++row;
  }
  return W;
}

/// For each column the largest norm among those with its unit.
Eigen::VectorXd largest_of_unit(const Robot& robot, const Eigen::VectorXd& norm) {
  Eigen::VectorXd largest = norm;
  const std::vector<std::string>& units = robot.parameter_units();
  for (Eigen::Index k = 0; k < norm.size(); ++k)
    for (Eigen::Index j = 0; j < norm.size(); ++j)
      if (units[static_cast<std::size_t>(j)] == units[static_cast<std::size_t>(k)])
        largest(k) = std::max(largest(k), norm(j));
  return largest;
}

std::string term(double coefficient, const std::string& name, bool first) {
  const double size = std::abs(coefficient);
  const std::string sign = coefficient < 0 ? (first ? "-" : " - ") : (first ? "" : " + ");
  return sign + (std::abs(size - 1) < kNegligible ? name : fmt::format("{:.6g} {}", size, name));
}

std::string expression(const Eigen::RowVectorXd& b, int independent, const std::vector<std::string>& names) {
  std::string text = term(1.0, names[static_cast<std::size_t>(independent)], true);
  for (Eigen::Index k = 0; k < b.size(); ++k) {
    if (k != independent && b(k) != 0) text += term(b(k), names[static_cast<std::size_t>(k)], false);
  }
  return text;
}

}  // namespace

BaseParameters find_base_parameters(const Robot& robot, const BaseParameterOptions& options) {
  if (options.states * robot.drives() < 2 * robot.parameters() || !(options.tolerance > 0 && options.tolerance < 1)) {
    throw Error("options for the base parameters are out of range", "states, tolerance",
                fmt::format("use at least {} states and a tolerance between 0 and 1",
                            2 * robot.parameters() / robot.drives() + 1),
                ExitCode::usage);
  }
  Eigen::MatrixXd W = random_regressor(robot, options);
  const Eigen::Index P = W.cols();
  Eigen::VectorXd norm = W.colwise().norm();
  const Eigen::VectorXd largest = largest_of_unit(robot, norm);
  for (Eigen::Index k = 0; k < P; ++k) {
    // A column without any effect: the mass of an arm that turns about a fixed axis, or the first moments of two equal
    // bars that turn opposite ways round, whose sum is rounding.
    if (norm(k) <= kVanishing * largest(k)) norm(k) = std::max(1.0, largest(k));
    W.col(k) /= norm(k);
  }
  const dense::PivotedQr qr(W);
  const Eigen::MatrixXd triangle = qr.R();
  const Eigen::VectorXd diagonal = triangle.diagonal().cwiseAbs();
  Eigen::Index rank = 0;
  while (rank < P && diagonal(rank) > options.tolerance * diagonal(0)) ++rank;

  BaseParameters base;
  base.rank_gap = rank < P ? diagonal(rank - 1) / std::max(diagonal(rank), 1e-300) : 1.0 / options.tolerance;
  if (base.rank_gap < 1e3) {
    throw Error(
        fmt::format("the number of base parameters cannot be told: the diagonal of R falls only {:.1f}-fold at {}",
                    base.rank_gap, rank),
        robot.description().name, "check the lengths of the robot; an almost singular design has no clear rank",
        ExitCode::not_trusted);
  }
  // W_dep = W_ind K, so that Y p = Y_ind (p_ind + K p_dep); undo the column scaling.
  const Eigen::MatrixXd R = triangle.topRows(rank);
  const Eigen::MatrixXd K = dense::solve_upper(R.leftCols(rank), Eigen::MatrixXd(R.rightCols(P - rank)));
  const std::vector<Eigen::Index> order = qr.order();
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(rank));
  for (Eigen::Index i = 0; i < rank; ++i) rows[static_cast<std::size_t>(i)] = i;
  std::sort(rows.begin(), rows.end(), [&](Eigen::Index a, Eigen::Index b) {
    return order[static_cast<std::size_t>(a)] < order[static_cast<std::size_t>(b)];
  });
  base.B = Eigen::MatrixXd::Zero(rank, P);
  for (Eigen::Index i = 0; i < rank; ++i) {
    const Eigen::Index row = rows[static_cast<std::size_t>(i)];
    const auto independent = static_cast<int>(order[static_cast<std::size_t>(row)]);
    base.independent.push_back(independent);
    base.B(i, independent) = 1.0;
    for (Eigen::Index j = 0; j < P - rank; ++j) {
      const Eigen::Index dependent = order[static_cast<std::size_t>(rank + j)];
      const double k = K(row, j);
      if (std::abs(k) > kNegligible) base.B(i, dependent) = k * norm(dependent) / norm(independent);
    }
    base.expressions.push_back(expression(base.B.row(i), independent, robot.parameter_names()));
    base.units.push_back(robot.parameter_units()[static_cast<std::size_t>(independent)]);
  }
  const Eigen::VectorXd s = dense::singular_values(W(Eigen::all, base.independent));
  base.condition_number = s(0) / s(rank - 1);
  return base;
}

}  // namespace deltadyn
