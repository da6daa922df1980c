#pragma once

/// \file
/// Torque that did not come from the drive: a hand that pushes the machine, a stop, something that it hits. The motion
/// shows it, the torque column does not, so that no model of the machine explains these rows.

#include <vector>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/signal/log.hpp"

namespace deltadyn::gate {

/// Finds stretches in which a drive would have needed more torque than it gave anywhere in the log, and weaker ones
/// besides once a log has one of them; marks them in Log::torque_out and says so, one finding a log and drive. Logs in
/// which such stretches were more than a quarter of the motion stay as they are: there the model is wrong, not the log.
[[nodiscard]] std::vector<LogFinding> leave_out_outside_torque(const Robot& robot, const BaseParameters& base,
                                                               std::vector<Log>& logs);

}  // namespace deltadyn::gate
