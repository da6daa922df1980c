#pragma once

/// \file
/// Noise in the regressor pulls parameters down: with E[n] = 0, E[(Y + dY)^T (Y + dY)] = Y^T Y + E[dY^T dY]. The encoders' step and
/// noise are known from the spectrum of the positions, so that this excess can be computed and taken off the folded normal
/// equations (bias-compensated least squares: Soederstroem, Automatica 43(6), 2007, section 6; the excess is simulated, as in the
/// SIMEX of Cook and Stefanski, JASA 89(428), 1994, and never extrapolated beyond the noise that is there).

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/identification/data_fold.hpp"
#include "deltadyn/identification/log_processing.hpp"
#include "deltadyn/signal/log.hpp"

namespace deltadyn {

/// Excess of the normal equations of each drive's usable rows, in the base parameters: mean of (Y + dY)^T (Y + dY) - Y^T Y and of
/// (Y + dY)^T tau - Y^T tau over the noise.
struct NoiseBias {
  std::vector<Eigen::MatrixXd> information;  ///< one a drive, base x base
  std::vector<Eigen::VectorXd> torque;       ///< one a drive, base
  double largest_share = 0;                  ///< of the information in its worst direction
};

/// Simulates the noise of each log's encoders (white, of the density that the spectrum shows) on top of the positions, in pairs of
/// opposite sign so that what is linear in the noise cancels. Rows are those that the fit uses.
/// \param keep_reversals  one a drive: rows near reversals count
/// \param draws           pairs of noise, of at most some ten thousand samples of each log
[[nodiscard]] NoiseBias simulate_noise_bias(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs,
                                            const ProcessingOptions& processing, const std::vector<bool>& keep_reversals,
                                            std::uint64_t seed = 1, int draws = 2);

/// Takes an excess off a triangular factor: R^T R - information and R^T d - torque, in the base parameters, become the new factor.
/// A direction in which noise is most of what there is stays as it is: nothing can be known there.
/// \param R, d  parameters x parameters, parameters; the factor of all drives together, weighted
void take_off_noise(const BaseParameters& base, const Eigen::MatrixXd& information, const Eigen::VectorXd& torque,
                    Eigen::MatrixXd& R, Eigen::VectorXd& d);

}  // namespace deltadyn
