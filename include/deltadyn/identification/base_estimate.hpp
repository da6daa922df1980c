#pragma once

/// \file
/// What least squares tells of the base parameters: values, covariance and the information behind them (paper IV.A).

#include <Eigen/Core>
#include <vector>

namespace deltadyn {

/// Noise of one drive as the fit sees it.
struct DriveNoise {
  double std = 1;  ///< of the torque residual [N m | N]
  /// Variance of a mean over the rows in units of that of white noise; above 1: fewer independent rows
  double correlation = 1;
};

/// Least-squares estimate of beta in tau = Y_B beta.
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

}  // namespace deltadyn
