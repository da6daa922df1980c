#pragma once

/// \file
/// Columns tried beside all base parameters: what they take off the squared residual with everything else fitted along.
/// A bristle's friction near reversals looks like inertia, a slow ripple like gravity; neither must be held where it
/// fits best without the column.

#include <Eigen/Core>
#include <vector>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/identification/log_processing.hpp"

namespace deltadyn {

/// The rows of one log in the base parameters.
struct BaseRows {
  std::vector<Eigen::MatrixXd> X;  ///< of each drive rows x base parameters
  Eigen::MatrixXd tau;             ///< rows x drives
  Eigen::MatrixXd weight;          ///< rows x drives: 1 / variance, or 0 for rows that do not count
  double rate_hz = 0;              ///< of the rows
};

/// \param use  what each row may be used for; the weights are left empty
[[nodiscard]] BaseRows base_rows(const Robot& robot, const BaseParameters& base, const PreparedLog& log, RowUses& use);

/// Weighs the rows whose weight is above 0 anew, by the residual of each drive and its memory.
/// \returns  mean square of each drive's residual before the last pass
Eigen::VectorXd weigh_by_residual(std::vector<BaseRows>& rows, int passes);

/// Columns of one log: one a amplitude, rows x drives.
using Columns = std::vector<Eigen::MatrixXd>;

class PartialFit {
 public:
  /// \param leave_out  base parameter that takes no part; -1: none
  explicit PartialFit(std::vector<BaseRows> rows, Eigen::Index leave_out = -1);

  struct Result {
    double cost = 0;                 ///< squared residual over the variance of the rows
    Eigen::VectorXd amplitude, std;  ///< one a column
  };
  /// \param columns  of each log
  [[nodiscard]] Result with(const std::vector<Columns>& columns) const;
  /// Squared residual without any column.
  [[nodiscard]] double square() const { return square_; }
  /// The base parameters without any column.
  [[nodiscard]] Eigen::VectorXd base_parameters() const { return solved(right_); }
  /// What the base parameters leave of the torque of a log, rows x drives.
  [[nodiscard]] Eigen::MatrixXd residual(std::size_t log) const;
  [[nodiscard]] const std::vector<BaseRows>& rows() const { return rows_; }

 private:
  [[nodiscard]] Eigen::VectorXd solved(const Eigen::VectorXd& right) const;

  std::vector<BaseRows> rows_;
  Eigen::Index leave_out_;
  Eigen::VectorXd right_, scale_;
  double square_ = 0;
  Eigen::MatrixXd inverse_;  ///< of the information
};

}  // namespace deltadyn
