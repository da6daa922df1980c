#pragma once

/// \file
/// Base parameters by weighted least squares with their covariance (paper IV.A).

#include <Eigen/Core>
#include <vector>

#include "deltadyn/identification/base_parameters.hpp"

#include "data_fold.hpp"
#include "noise_bias.hpp"

namespace deltadyn {

/// Parameters of the full set that reproduce beta: the dependent ones 0. Not physical; Y p is what counts.
[[nodiscard]] Eigen::VectorXd any_parameters(const BaseParameters& base, const Eigen::Ref<const Eigen::VectorXd>& beta,
                                             Eigen::Index parameters);

/// First pass weighted by W_tau = diag(tau_max)^-2 (paper IV.A), then by Sigma^-1 from the residual until it settles.
/// \param folds        one a drive
/// \param correlation  DriveNoise::correlation of each drive, or empty (all 1)
/// \param bias         what encoder noise adds to the normal equations, to be taken off; null: nothing
/// Throws deltadyn::Error (not_trusted) naming the base parameters that the motion does not show, and (bad_input) for
/// too few rows.
[[nodiscard]] BaseEstimate estimate_base_parameters(const BaseParameters& base, const std::vector<DriveFold>& folds,
                                                    const std::vector<double>& correlation = {},
                                                    const NoiseBias* bias = nullptr);

/// Adds the covariance of another source of error to an estimate; A and b say so, too.
/// \param covariance  base x base, positive semidefinite
void add_uncertainty(const BaseParameters& base, const Eigen::MatrixXd& covariance, BaseEstimate& estimate);

/// Ratio of the variance of a mean to that of white noise with the same variance: 1 + 2 sum of the autocorrelations,
/// with a Bartlett window over `lags` lags (Newey and West 1987).
/// \param usable  samples to take, the others count as gaps
/// \param white   what noise gives that was white before it was filtered (FirDecimator::white_correlation); the answer
///                if the residual does not clearly say otherwise
[[nodiscard]] double noise_correlation(const Eigen::Ref<const Eigen::VectorXd>& residual,
                                       const Eigen::Ref<const Eigen::Array<bool, Eigen::Dynamic, 1>>& usable,
                                       Eigen::Index lags, double white = 1);

/// noise_correlation() over the time that the residual of a torque remembers.
[[nodiscard]] double residual_memory(const Eigen::Ref<const Eigen::VectorXd>& residual,
                                     const Eigen::Ref<const Eigen::Array<bool, Eigen::Dynamic, 1>>& usable,
                                     double row_rate_hz, double white = 1);

}  // namespace deltadyn
