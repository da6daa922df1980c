#pragma once

/// \file
/// Base parameters by weighted least squares with their covariance (paper IV.A).

#include <Eigen/Core>
#include <vector>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/identification/data_fold.hpp"
#include "deltadyn/identification/noise_bias.hpp"

namespace deltadyn {

/// Noise of one drive as the fit sees it.
struct DriveNoise {
  double std = 1;          ///< of the torque residual [N m | N]
  double correlation = 1;  ///< variance of a mean over the rows in units of that of white noise; above 1: fewer independent rows
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

/// Parameters of the full set that reproduce beta: the dependent ones 0. Not physical; Y p is what counts.
[[nodiscard]] Eigen::VectorXd any_parameters(const BaseParameters& base, const Eigen::Ref<const Eigen::VectorXd>& beta,
                                             Eigen::Index parameters);

/// First pass weighted by W_tau = diag(tau_max)^-2 (paper IV.A), then by Sigma^-1 from the residual until it settles.
/// \param folds        one a drive
/// \param correlation  DriveNoise::correlation of each drive, or empty (all 1)
/// \param bias         what encoder noise adds to the normal equations, to be taken off; null: nothing
/// Throws deltadyn::Error (not_trusted) naming the base parameters that the motion does not show, and (bad_input) for too few rows.
[[nodiscard]] BaseEstimate estimate_base_parameters(const BaseParameters& base, const std::vector<DriveFold>& folds,
                                                    const std::vector<double>& correlation = {}, const NoiseBias* bias = nullptr);

/// Adds the covariance of another source of error to an estimate; A and b say so, too.
/// \param covariance  base x base, positive semidefinite
void add_uncertainty(const BaseParameters& base, const Eigen::MatrixXd& covariance, BaseEstimate& estimate);

/// Ratio of the variance of a mean to that of white noise with the same variance: 1 + 2 sum of the autocorrelations, with a
/// Bartlett window over `lags` lags (Newey and West 1987).
/// \param usable  samples to take, the others count as gaps
/// \param white   what noise gives that was white before it was filtered (FirDecimator::white_correlation); the answer if the residual
///                does not clearly say otherwise
[[nodiscard]] double noise_correlation(const Eigen::Ref<const Eigen::VectorXd>& residual,
                                       const Eigen::Ref<const Eigen::Array<bool, Eigen::Dynamic, 1>>& usable, Eigen::Index lags,
                                       double white = 1);

}  // namespace deltadyn
