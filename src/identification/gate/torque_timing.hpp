#pragma once

/// \file
/// Hypothesis: the torque is late or early against the positions, or a first-order low pass stands between the recorded
/// torque and the one that acted. Estimated together with the base parameters: what the torque, set right, leaves
/// unexplained is smallest at the true delay.

#include <Eigen/Core>
#include <vector>

#include "rows.hpp"

namespace deltadyn::gate {

/// Delay and time constant of each drive's torque, logs x drives [s].
struct Shifts {
  Eigen::MatrixXd delay;  ///< positive: the torque comes late
  /// Time constant of a low pass: positive, the record is behind it; negative, the motor (a command was recorded).
  Eigen::MatrixXd lag;
};

struct Timing {
  Shifts shift, std;
  bool significant = false;              ///< anything to remove at all
  double rms_before = 0, rms_after = 0;  ///< relative residual of the base parameters: as recorded, and moved back
};

/// \param rows     of low_passed_rows(), as given
/// \param logs     number of logs
/// \param least_s  smaller delays are left alone, one value a log [s]
[[nodiscard]] Timing estimate_timing(const Sample& sample, const Rows& rows, const std::vector<double>& least_s);

/// One delay a log, whether they differ or not.
struct LogDelays {
  Eigen::VectorXd delay_s;               ///< one a log; empty if too few rows tell them
  double rms_before = 0, rms_after = 0;  ///< relative residual with one delay for all logs, and with these
};
[[nodiscard]] LogDelays delays_of_logs(const Sample& sample, const Rows& rows, int logs);

}  // namespace deltadyn::gate
