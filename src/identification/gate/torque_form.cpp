#include "torque_form.hpp"

#include <algorithm>
#include <cmath>

#include "deltadyn/runtime/dense.hpp"

namespace deltadyn::gate {

namespace {

using Eigen::Index;

// Of the scaled normal equations: directions that the motion does not show stay finite
constexpr double kRidge = 1e-11;

/// Columns scaled to norm 1, so that the ridge means the same for all.
Eigen::MatrixXd scaled_information(const Eigen::MatrixXd& A, Eigen::VectorXd& scale) {
  scale = A.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  for (Index k = 0; k < scale.size(); ++k) {
    if (A(k, k) <= 0) scale(k) = 0;
  }
  Eigen::MatrixXd scaled = scale.asDiagonal() * A * scale.asDiagonal();
  scaled.diagonal().array() += kRidge;
  return scaled;
}

}  // namespace

std::vector<TorqueBlock> fold_torques(const Rows& rows, const Eigen::MatrixXd& tau) {
  std::vector<TorqueBlock> blocks;
  for (const DriveRows& drive : rows.drives) {
    Eigen::MatrixXd Y = drive.Y, t = drive.of_points(tau);
    if (Y.rows() > 0) {
      Y.rowwise() -= Eigen::RowVectorXd(Y.colwise().mean());
      t.rowwise() -= Eigen::RowVectorXd(t.colwise().mean());
    }
    blocks.push_back({Y.transpose() * Y, Y.transpose() * t, t.colwise().squaredNorm().transpose(), Y.rows()});
  }
  return blocks;
}

Eigen::MatrixXd residual_form(const std::vector<TorqueBlock>& blocks, const std::vector<int>& assignment,
                              const Eigen::VectorXd& factor) {
  const auto n = static_cast<Index>(blocks.size());
  const Index B = blocks.front().YtY.cols();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(B, B), rhs(B, n), form = Eigen::MatrixXd::Zero(n, n);
  for (Index j = 0; j < n; ++j) {
    const TorqueBlock& block = blocks[static_cast<std::size_t>(j)];
    const int column = assignment[static_cast<std::size_t>(j)];
    const double w2 = 1.0 / std::max(block.tau2(column), 1e-300);
    A += w2 / (factor(j) * factor(j)) * block.YtY;
    rhs.col(j) = w2 / factor(j) * block.Ytau.col(column);
    form(j, j) = 1.0;
  }
  Eigen::VectorXd scale;
  const Eigen::MatrixXd scaled = scaled_information(A, scale);
  rhs = scale.asDiagonal() * rhs;
  const Eigen::MatrixXd solution = dense::solve_symmetric(scaled, rhs);
  form.noalias() -= rhs.transpose() * solution;
  return form;
}

double relative_residual(const Eigen::MatrixXd& form, const Eigen::VectorXd& s) {
  return std::sqrt(std::max(0.0, s.dot(form * s)) / std::max(s.squaredNorm(), 1e-300));
}

Eigen::VectorXd own_residuals(const std::vector<TorqueBlock>& blocks) {
  Eigen::VectorXd out(static_cast<Index>(blocks.size()));
  for (Index j = 0; j < out.size(); ++j) {
    const TorqueBlock& block = blocks[static_cast<std::size_t>(j)];
    Eigen::VectorXd scale;
    const Eigen::MatrixXd scaled = scaled_information(block.YtY, scale);
    const Eigen::VectorXd rhs = scale.asDiagonal() * block.Ytau.col(j);
    const double left = block.tau2(j) - rhs.dot(dense::solve_symmetric(scaled, rhs));
    // Parameters of its own follow the noise of few rows.
    const double rows = static_cast<double>(block.rows), free = static_cast<double>(block.YtY.cols());
    const double freedom = rows > 1.5 * free ? rows / (rows - free) : 3.0;
    out(j) = std::sqrt(freedom * std::max(0.0, left) / std::max(block.tau2(j), 1e-300));
  }
  return out;
}

Factor best_factor(const std::vector<TorqueBlock>& blocks, const std::vector<int>& assignment, int drive) {
  const auto n = static_cast<Index>(blocks.size());
  Eigen::VectorXd factor = Eigen::VectorXd::Ones(n), s = factor;
  Factor out;
  // A drive counts against its own torque: with every new factor the weights follow.
  for (int pass = 0; pass < 8; ++pass) {
    const Eigen::MatrixXd form = residual_form(blocks, assignment, factor.cwiseAbs());
    const double diagonal = std::max(form(drive, drive), 1e-12);
    s(drive) = 0;
    const double step = -form.row(drive).dot(s) / diagonal;
    s(drive) = step;
    const double before = factor(drive);
    factor(drive) = std::abs(before) * step;
    out.value = factor(drive);
    // Every drive's rows weigh 1 / rows in the form, so one row's noise has this share of the residual.
    const double rows = static_cast<double>(std::max<Index>(1, blocks[static_cast<std::size_t>(drive)].rows));
    out.std = std::abs(before) * std::sqrt(std::max(0.0, s.dot(form * s)) / static_cast<double>(n) / rows / diagonal);
    s(drive) = step < 0 ? -1 : 1;
    if (std::abs(factor(drive)) < 1e-9 || std::abs(out.value - before) < 1e-6 * std::abs(before)) break;
  }
  return out;
}

}  // namespace deltadyn::gate
