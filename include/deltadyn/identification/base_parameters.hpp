#pragma once

/// \file
/// Base parameters: the linear combinations of parameters that the motion of the drives can show at all, and what least
/// squares tells of them (paper IV.A).

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

struct BaseParameterOptions {
  int states = 400;  ///< random task-space states; drives x states must be well above the number of columns
  std::uint64_t seed = 1;
  /// A diagonal entry of R below tolerance x the largest counts as zero (columns have norm 1)
  double tolerance = 1e-9;
};

/// beta = B p, with B the identity on the independent columns. Y p = Y_B beta for every state.
struct BaseParameters {
  std::vector<int> independent;          ///< columns of Y that make Y_B, ascending
  Eigen::MatrixXd B;                     ///< count x parameters
  std::vector<std::string> expressions;  ///< "strut.Iyy + 0.61 platform.m - ...", one a base parameter
  std::vector<std::string> units;
  double rank_gap = 0;          ///< last kept over first dropped diagonal entry of R: large when the count is certain
  double condition_number = 0;  ///< of Y_B over the random states, columns scaled to norm 1

  [[nodiscard]] int count() const { return static_cast<int>(independent.size()); }
  /// Place of a column of Y among the independent ones; -1: it is none of them.
  [[nodiscard]] Eigen::Index place_of(Eigen::Index column) const {
    const auto at = std::ranges::find(independent, column);
    return at == independent.end() ? -1 : at - independent.begin();
  }
};

/// Noise of one drive as the fit sees it.
struct DriveNoise {
  double std = 1;  ///< of the torque residual [N m | N]
  /// Variance of a mean over the rows in units of that of white noise; above 1: fewer independent rows
  double correlation = 1;
};

/// Least-squares estimate of beta in tau = Y_B beta: values, covariance and the information behind them.
struct BaseEstimate {
  Eigen::VectorXd value;       ///< one a base parameter
  Eigen::MatrixXd covariance;  ///< from the residual
  std::vector<DriveNoise> noise;
  double condition_number = 0;  ///< of the weighted Y_B with columns scaled to norm 1
  double log_det = 0;           ///< of the information matrix Y_B^T W Y_B
  /// A p = b in units of the noise: A^T A is the information matrix of the full parameters. parameters x parameters.
  Eigen::MatrixXd A;
  Eigen::VectorXd b;

  [[nodiscard]] Eigen::VectorXd std() const { return covariance.diagonal().cwiseMax(0.0).cwiseSqrt(); }
};

/// Rank-revealing QR of the regressor over random states.
/// Throws deltadyn::Error for options out of range and if the rank cannot be told (no gap in R).
[[nodiscard]] BaseParameters find_base_parameters(const Robot& robot, const BaseParameterOptions& options = {});

}  // namespace deltadyn
