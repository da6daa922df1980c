#pragma once

/// \file
/// Noise in the regressor pulls parameters down: with E[dY] = 0, E[(Y + dY)^T (Y + dY)] = Y^T Y + E[dY^T dY].
/// Instrumental variables that the noise does not reach take it out (Janot, Vandanjon, Gautier, IEEE TCST 22(1), 2014,
/// take them from a simulated robot). Here they are the regressor Z of the same rows from positions that are filtered
/// down to the band of the motion, where the encoders' noise is small whatever its colour. In two stages (Theil 1953):
/// Y is replaced by what Z explains of it, so the normal equations become Y^T P Y beta = Y^T P tau with P = Z (Z^T
/// Z)^-1 Z^T; what they lose is the excess of the noise.

#include <Eigen/Core>
#include <vector>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/identification/log_processing.hpp"
#include "deltadyn/signal/log.hpp"

#include "data_fold.hpp"

namespace deltadyn {

/// Excess of the normal equations of each drive's usable rows, in the base parameters: Y^T (1 - P) Y and Y^T (1 - P)
/// tau.
struct NoiseBias {
  std::vector<Eigen::MatrixXd> information;  ///< one a drive, base x base
  std::vector<Eigen::VectorXd> torque;       ///< one a drive, base
};

/// Zero if the motion is filtered as narrowly as the instruments anyway. Rows are those that the fit uses; of long
/// logs, some hundred thousand samples.
/// \param keep_reversals  one a drive: rows near reversals count
/// \param instrument_hz   -3 dB point of the positions' filter behind the instruments: nearly all of the motion
/// Throws deltadyn::Error as prepare_log does.
[[nodiscard]] NoiseBias noise_bias(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs,
                                   const ProcessingOptions& processing, const std::vector<bool>& keep_reversals,
                                   double instrument_hz);

/// Takes an excess off a triangular factor: R^T R - information and R^T d - torque, in the base parameters, become the
/// new factor. A direction in which noise is nearly all that there is stays as it is: nothing can be known there.
/// \param R, d  parameters x parameters, parameters; the factor of all drives together, weighted
void take_off_noise(const BaseParameters& base, const Eigen::MatrixXd& information, const Eigen::VectorXd& torque,
                    Eigen::MatrixXd& R, Eigen::VectorXd& d);

}  // namespace deltadyn
