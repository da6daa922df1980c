#pragma once

/// \file
/// What the scale of the torque, the efforts and the position limits of the robot file say about a log.

#include <vector>

#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/signal/log.hpp"

#include "torque_scale.hpp"

namespace deltadyn::gate {

/// Signs and sizes of inertia and weight that no machine of this prior has.
[[nodiscard]] std::vector<LogFinding> scale_findings(const RobotDescription& robot, const TorqueScale& scale);

/// Torques, positions and rates far beyond the limits of the robot file.
/// \param moving  the rows follow one another in time
[[nodiscard]] std::vector<LogFinding> limit_findings(const RobotDescription& robot, const std::vector<Log>& logs,
                                                     bool moving);

/// An articulated plate that would turn farther than its parts let it.
[[nodiscard]] std::vector<LogFinding> plate_findings(const Robot& robot, const std::vector<Log>& logs);

}  // namespace deltadyn::gate
