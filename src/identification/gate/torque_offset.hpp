#pragma once

/// \file
/// A recorded torque whose zero is off.

#include <optional>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/signal/log_finding.hpp"

#include "rows.hpp"

namespace deltadyn::gate {

/// Drives whose torque has an offset, of each its own, where that explains most of a residual, down to that of a sound
/// log. Nothing for a robot whose parameters hold offsets. A warning: friction that differs by direction is one, too,
/// and a load on the plate is nearly one of all drives.
struct TorqueOffset {
  LogFinding finding;
  Eigen::VectorXd value;  ///< of each drive [N m | N]; 0: none
};
[[nodiscard]] std::optional<TorqueOffset> torque_offset(const Robot& robot, const BaseParameters& base,
                                                        const Points& points);

}  // namespace deltadyn::gate
