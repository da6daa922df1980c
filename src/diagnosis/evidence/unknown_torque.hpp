#pragma once

/// \file
/// Samples at which nothing is known of a drive's torque, as the low-passed rows see them. About a velocity reversal
/// friction follows no law of the rate: it sticks, creeps and breaks away, and the measured rate has no certain sign.
/// What happens there for a few milliseconds reaches every row within the low pass, but in a few directions only, so
/// that most of each row can still be used.

#include <vector>

#include "deltadyn/identification/log_processing.hpp"

#include "noise_model.hpp"

namespace deltadyn {

/// What one stretch of unknown samples can add to the rows from `first` on.
struct UnknownTorque {
  Index first = 0;
  /// Rows x directions, orthogonal, each as large [N m or N] as an error of the drive's torque can make it
  MatrixXd directions;
};

/// The stretches of samples that PreparedLog::reversal marks for a drive.
/// \param present  set to false at rows that lie deep inside a long stretch (the joint stands), where nothing is known
///                 at all
[[nodiscard]] std::vector<UnknownTorque> unknown_torque(const PreparedLog& log, Index drive, RowMask& present);

}  // namespace deltadyn
