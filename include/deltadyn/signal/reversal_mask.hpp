#pragma once

/// \file
/// Samples near a reversal of motion, where the sign of the velocity is uncertain and with it the Coulomb friction.

#include <Eigen/Core>
#include <vector>

namespace deltadyn {

/// 1 for each sample with |rate| < threshold, at a change of sign between two samples, and for `grow` samples on either
/// side.
/// \param rate       N rates of one joint [rad/s | m/s]
/// \param threshold  [rad/s | m/s], not negative
/// Throws Error(usage) if threshold or grow is negative.
[[nodiscard]] std::vector<char> reversal_mask(const Eigen::Ref<const Eigen::VectorXd>& rate, double threshold,
                                              Eigen::Index grow);

/// Std of the white noise (mostly quantisation) on recorded positions, by their fourth differences; robust against
/// single outliers. For an encoder at rest, its resolution over sqrt(12); 0 for a constant column.
/// \param position  N positions [rad | m]
[[nodiscard]] double position_noise(const Eigen::Ref<const Eigen::VectorXd>& position);

/// Standard deviation of the first or second derivative behind the zero-phase filter, for white noise on the positions.
/// \param position_noise  standard deviation, e.g. of position_noise() [rad | m]
/// \param cutoff_hz,order of zero_phase_filter()
/// \param derivative      1 or 2
/// \return                [rad/s | m/s] or [rad/s^2 | m/s^2]
[[nodiscard]] double derivative_noise(double position_noise, double sample_rate_hz, double cutoff_hz, int order,
                                      int derivative);

}  // namespace deltadyn
