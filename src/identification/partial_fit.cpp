#include "partial_fit.hpp"

#include <algorithm>
#include <utility>

#include "deltadyn/runtime/dense.hpp"

#include "least_squares.hpp"

namespace deltadyn {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

BaseRows base_rows(const Robot& robot, const BaseParameters& base, const PreparedLog& log, RowUses& use) {
  RowBlock block;
  read_rows(robot, log, 0, log.rows, block);
  BaseRows out;
  for (const MatrixXd& Y : block.Y) out.X.emplace_back(Y(Eigen::all, base.independent));
  out.tau = std::move(block.tau);
  use = std::move(block.use);
  out.rate_hz = log.row_rate_hz();
  return out;
}

VectorXd weigh_by_residual(std::vector<BaseRows>& rows, int passes) {
  VectorXd mean_square = VectorXd::Zero(rows.front().tau.cols());
  for (int pass = 0; pass < passes; ++pass) {
    const PartialFit fit(rows);
    for (Index j = 0; j < mean_square.size(); ++j) {
      double square = 0, count = 0, memory = 1;
      for (std::size_t l = 0; l < rows.size(); ++l) {
        const VectorXd e = fit.residual(l).col(j);
        const Eigen::Array<bool, Eigen::Dynamic, 1> usable = rows[l].weight.col(j).array() > 0;
        square += usable.select(e.array(), 0.0).square().sum();
        count += static_cast<double>(usable.count());
        memory = std::max(memory, residual_memory(e, usable, rows[l].rate_hz));
      }
      const double weight = count > 0 ? count / std::max(square * memory, 1e-300) : 0.0;
      for (BaseRows& log : rows)
        log.weight.col(j) = (log.weight.col(j).array() > 0).select(weight, VectorXd::Zero(log.weight.rows()));
      mean_square(j) = count > 0 ? square / count : 0.0;
    }
  }
  return mean_square;
}

PartialFit::PartialFit(std::vector<BaseRows> rows, Index leave_out) : rows_(std::move(rows)), leave_out_(leave_out) {
  const Index count = rows_.front().X.front().cols();
  MatrixXd information = MatrixXd::Zero(count, count);
  right_.setZero(count);
  for (const BaseRows& log : rows_) {
    for (Index j = 0; j < log.tau.cols(); ++j) {
      const MatrixXd& X = log.X[static_cast<std::size_t>(j)];
      const MatrixXd weighted = log.weight.col(j).asDiagonal() * X;
      information += X.transpose() * weighted;
      right_ += weighted.transpose() * log.tau.col(j);
      square_ += log.weight.col(j).dot(log.tau.col(j).cwiseAbs2());
    }
  }
  if (leave_out_ >= 0) {
    information.row(leave_out_).setZero();
    information.col(leave_out_).setZero();
    right_(leave_out_) = 0;
  }
  scale_ = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  if (leave_out_ >= 0) scale_(leave_out_) = 0;
  inverse_ = scale_.asDiagonal() * dense::pseudo_inverse(scale_.asDiagonal() * information * scale_.asDiagonal()) *
             scale_.asDiagonal();
  square_ -= right_.dot(solved(right_));
}

VectorXd PartialFit::solved(const VectorXd& right) const {
  return inverse_ * right;
}

PartialFit::Result PartialFit::with(const std::vector<Columns>& columns) const {
  const auto n = static_cast<Index>(columns.front().size());
  MatrixXd XC = MatrixXd::Zero(right_.size(), n), CC = MatrixXd::Zero(n, n);
  VectorXd Cy = VectorXd::Zero(n);
  for (std::size_t l = 0; l < rows_.size(); ++l) {
    const BaseRows& log = rows_[l];
    for (Index j = 0; j < log.tau.cols(); ++j) {
      MatrixXd C(log.tau.rows(), n);
      for (Index c = 0; c < n; ++c) C.col(c) = columns[l][static_cast<std::size_t>(c)].col(j);
      if ((C.array() == 0).all()) continue;
      const MatrixXd weighted = log.weight.col(j).asDiagonal() * C;
      XC += log.X[static_cast<std::size_t>(j)].transpose() * weighted;
      CC += C.transpose() * weighted;
      Cy += weighted.transpose() * log.tau.col(j);
    }
  }
  if (leave_out_ >= 0) XC.row(leave_out_).setZero();
  for (Index c = 0; c < n; ++c) {
    const VectorXd part = solved(XC.col(c));
    CC.col(c) -= XC.transpose() * part;
    Cy(c) -= right_.dot(part);
  }
  const MatrixXd covariance = dense::pseudo_inverse(CC);
  Result out;
  out.amplitude = covariance * Cy;
  out.std = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  out.cost = square_ - out.amplitude.dot(Cy);
  return out;
}

MatrixXd PartialFit::residual(std::size_t log) const {
  const VectorXd beta = base_parameters();
  MatrixXd out = rows_[log].tau;
  for (Index j = 0; j < out.cols(); ++j) out.col(j) -= rows_[log].X[static_cast<std::size_t>(j)] * beta;
  return out;
}

}  // namespace deltadyn
