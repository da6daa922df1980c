#pragma once

/// \file
/// Is a recorded log fit for use? Repairs what is safe to repair and refuses the rest, with file, line and column.

#include <vector>

#include "deltadyn/runtime/robot_description.hpp"
#include "deltadyn/signal/log.hpp"

namespace deltadyn {

struct LogCheckOptions {
  /// false: the rows are states of their own, not a motion recorded evenly in time (a table of poses); only missing
  /// numbers, implausible positions and limits are looked at.
  bool motion = true;
  /// false: positions and rates that the robot cannot have are let through, because examine_logs() names what they
  /// are (degrees, a gear, a zero).
  bool refuse_positions = true;
};

/// Checks a log and mends what is certain and harmless, with one finding for each kind of fault (Log::findings,
/// Log::notes):
/// - stamps: rows that are there twice, single wrong stamps, a clock coarser than the sampling or one that drifts,
///   stamps that jitter about even samples, samples taken at uneven times (moved to even steps);
/// - counters that ran over; rows that hold the values of the row before; channels that change only every n-th row (the
///   log comes to that rate, in phase);
/// - lost rows, missing numbers and spikes of a few samples: filled from their neighbours, marked in Log::filled. Where
///   the filling is as good as the channel's noise the rows stay in use (Log::kBridged), else they are left out
///   (Log::kLeftOut);
/// - torque of a drive at rest, cut off, or constant because the servo is off: left out (Log::torque_out).
///
/// At gaps longer than can be filled, and where the stamps of another recording begin, the log falls into parts, which
/// have the same Log::file and are numbered by Log::part. Parts that are too short or cannot be used are left away, and
/// that is said. What was measured on the way (rate, jitter, steps, noise, travel) is a finding of level fine, in the
/// first part.
/// \return  at least one part; in each t_s is even and every number is finite
/// Throws Error(bad_input) with file, line and column for everything else: positions in degrees, stuck encoders, lost
/// counts, ...
[[nodiscard]] std::vector<Log> check_and_split(Log log, const RobotDescription& robot,
                                               const LogCheckOptions& options = {});

/// check_and_split() of a log without gaps, in place. Throws Error(bad_input) if it falls into several parts.
void check_and_repair(Log& log, const RobotDescription& robot, const LogCheckOptions& options = {});

}  // namespace deltadyn
