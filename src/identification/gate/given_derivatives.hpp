#pragma once

/// \file
/// Hypothesis: the recorded rates and accelerations are not the derivatives of the recorded positions: late, in another
/// unit, of the other sign, or zero.

#include <vector>

#include "deltadyn/runtime/robot_description.hpp"
#include "deltadyn/signal/log.hpp"

namespace deltadyn::gate {

/// \param used  the tool takes the recorded derivatives as they are: a fault spoils the result, else it is only said
[[nodiscard]] std::vector<LogFinding> examine_derivatives(const RobotDescription& robot, const Log& log, bool used);

}  // namespace deltadyn::gate
