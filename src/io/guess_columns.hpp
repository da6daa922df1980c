#pragma once

/// \file
/// Which columns of a recording are the drives' positions and torques, from their names.

#include <optional>
#include <string>
#include <vector>

#include "deltadyn/io/column_map.hpp"
#include "deltadyn/io/recording.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {

/// "q1_rad", "tau1_Nm": the name that a quantity of a drive has in a log of these tools.
/// \param drive  from 0
[[nodiscard]] std::string contract_name(const RobotDescription& robot, int drive, Quantity quantity);

/// Units that a maker or a message states by custom, not in the header: ROS (REP 103) is SI, UR's RTDE is rad, A, N m.
/// Empty: none.
/// \param stem  the column's name without its unit; "/" for a message whose form says the quantity
[[nodiscard]] std::string customary_unit(const std::string& stem, Quantity quantity, DriveKind kind);

/// Adds the channels of one quantity to `map`, for every drive or for none. Never chooses between equals: where two
/// sets of columns fit alike, a unit is not stated, or only commanded positions are there, nothing is added. Returns
/// what could then not be decided, and how the user can.
/// \param notes  where the order of the drives rests on more than plain names, it is said here
[[nodiscard]] std::optional<Error> guess_channels(const Recording& recording, const RobotDescription& robot,
                                                  Quantity quantity, const MapDefaults& defaults, ColumnMap& map,
                                                  std::vector<std::string>& notes);

}  // namespace deltadyn
