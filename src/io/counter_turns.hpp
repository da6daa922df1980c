#pragma once

/// \file
/// Encoder counters that begin again, and which of their turns a recording starts on.

#include <Eigen/Core>
#include <string>

#include "deltadyn/io/column_map.hpp"
#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn {

/// Takes the jumps of a counter out of recorded positions, and shifts them by the whole turns of the counter that bring
/// the travel inside the limits of the robot file, if just one number of turns does. Returns what was done and what is
/// left open, in words without the file's and column's name; empty: nothing.
/// \param factor  from the recorded number to SI at the drive, scale and sign included
[[nodiscard]] std::string settle_counter(Eigen::Ref<Eigen::VectorXd> values, const ChannelMap& map, double factor,
                                         DriveKind kind, const DriveLimits& limits);

}  // namespace deltadyn
