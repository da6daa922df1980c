#pragma once

/// \file
/// From recorded positions to positions, rates and accelerations of the drives.

#include <Eigen/Core>

#include "deltadyn/signal/log.hpp"

namespace deltadyn {

/// Motion of the drives at the sample times of the log. Rows outside [first, last) are disturbed by the ends of the
/// log.
struct DriveMotion {
  Eigen::MatrixXd q;    ///< N x drives [rad | m]
  Eigen::MatrixXd qd;   ///< N x drives [rad/s | m/s]
  Eigen::MatrixXd qdd;  ///< N x drives [rad/s^2 | m/s^2]
  Eigen::Index first = 0;
  Eigen::Index last = 0;
};

/// q through the zero-phase Butterworth filter, qd and qdd by central differences of sixth order of the filtered q.
/// \param cutoff_hz  -3 dB of the zero-phase filter; at or beyond half the sample rate q is not filtered
/// \param order      of one pass of the filter
/// \param trim_s     disturbed time at either end; negative: 1.5 / cutoff_hz
/// Throws Error(bad_input) if nothing is left between the trimmed ends.
[[nodiscard]] DriveMotion differentiate_log(const Log& log, double cutoff_hz, int order = 4, double trim_s = -1.0);

}  // namespace deltadyn
