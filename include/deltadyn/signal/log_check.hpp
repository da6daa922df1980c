#pragma once

/// \file
/// Is a recorded log fit for use? Repairs what is safe to repair and refuses the rest, with file, line and column.

#include <string>
#include <vector>

#include "deltadyn/runtime/robot_description.hpp"
#include "deltadyn/signal/log.hpp"

namespace deltadyn {

struct LogCheckOptions {
  /// false: the rows are states of their own, not a motion recorded evenly in time (a table of poses); only missing numbers,
  /// implausible positions and limits are looked at.
  bool motion = true;
  int max_filled_gap = 3;              ///< longest run of missing samples that is filled in
  double max_filled_share = 0.01;      ///< largest share of samples that may be filled in
  double max_stamp_jitter = 0.02;      ///< up to this share of the sample time, stamps are set to the even grid
  double max_resampled_jitter = 0.45;  ///< up to this share, the log is resampled onto the even grid
  Eigen::Index min_samples = 50;       ///< shorter logs are refused
  double min_duration_s = 0.5;         ///< shorter logs are refused
  double max_saturated_share = 0.05;   ///< of samples where the torque is cut off; fewer are only left out of fits
  double stuck_time_s = 0.1;           ///< a position constant for longer while it should move is a stuck encoder
  double outlier_ratio = 30.0;         ///< a sample this many times farther from the cubic through its neighbours than usual

  /// Throws Error(usage) if a value is out of range.
  void validate() const;
};

/// What was found, for reports. Everything in it is also a note of the log.
struct LogFindings {
  std::vector<std::string> notes;       ///< in plain words, with line numbers
  Eigen::Index filled_samples = 0;      ///< missing or spoilt samples that were filled in (Log::filled)
  Eigen::Index dropped_duplicates = 0;  ///< rows that were there twice
  double largest_jitter = 0.0;          ///< of the time stamps, share of the sample time
  bool resampled = false;               ///< values were moved onto the even grid by cubic interpolation
};

/// Checks a log, in this order: counts, time stamps, missing numbers, positions in degrees, limits, single-sample spikes,
/// stuck encoders, saturated torque, excitation.
///
/// Repaired, with a note: exact duplicates of a row, stamps with rounding or jitter, short gaps and missing numbers and
/// single-sample spikes (positions by a cubic, torque by a line, sample marked in Log::filled); samples where the torque
/// is cut off are marked too.
/// Afterwards Log::t_s is even and every number is finite. Throws Error(bad_input) for everything else.
LogFindings check_and_repair(Log& log, const RobotDescription& robot, const LogCheckOptions& options = {});

}  // namespace deltadyn
