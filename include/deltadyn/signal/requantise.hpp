#pragma once

/// \file
/// What a recording would have looked like with its encoders turned by a part of a step: the error that their steps
/// make follows the motion where few steps pass, and then averages out less than white noise does.

#include <Eigen/Core>
#include <random>

#include "deltadyn/signal/log.hpp"

namespace deltadyn {

/// Step of each drive's recorded positions [rad | m]; 0 where none shows.
[[nodiscard]] Eigen::VectorXd position_steps(const Log& log);

/// The log with its positions smoothed and then rounded to steps of another phase, each drive's drawn anew.
/// \param smooth     N x drives, the motion [rad | m]
/// \param step       one a drive; 0: as smoothed
[[nodiscard]] Log requantised(const Log& log, const Eigen::MatrixXd& smooth, const Eigen::VectorXd& step,
                              std::mt19937_64& random);

}  // namespace deltadyn
