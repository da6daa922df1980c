#pragma once

/// \file
/// The most telling structure that a model leaves in the residual of single logs: which log, drive and speed range, and
/// how large it is beside the torque there. A slow log's friction must not drown in the torque of a fast one.

#include <optional>
#include <string>

#include "deltadyn/identification/validate.hpp"

namespace deltadyn {

/// Residual of one drive in one log that is no noise.
struct StructureLeft {
  std::string file;
  int drive = 0;  ///< from 0
  /// Of the drive: "velocity", "position", "acceleration"; "time" for slow waves that follow none of them
  std::string coordinate;
  double share = 0;      ///< of the residual's mean square in that log
  double of_torque = 0;  ///< rms of that part over the rms torque of the drive in that log
  /// Range of speed in which a friction-like residual is largest beside the torque of that range [rad/s | m/s].
  double speed_low = 0, speed_high = 0;
  double of_torque_there = 0;  ///< 0 if none stands out
};

/// The largest by of_torque, or of_torque_there where that is larger; nothing if all residuals look like noise.
[[nodiscard]] std::optional<StructureLeft> structure_left(const Validation& validation);

}  // namespace deltadyn
