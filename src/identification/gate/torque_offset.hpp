#pragma once

/// \file
/// A recorded torque whose zero is off.

#include <optional>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/signal/log_finding.hpp"

#include "rows.hpp"

namespace deltadyn::gate {

/// The torque of one or two drives with an offset that explains most of a residual, down to that of a sound log. Nothing for a robot
/// whose parameters hold offsets. Loads and springs act on all drives; they are no offset of one.
/// A warning: friction that differs by direction is one, too.
struct TorqueOffset {
  LogFinding finding;
  Eigen::VectorXd value;  ///< of each drive [N m | N]; 0: none
};
[[nodiscard]] std::optional<TorqueOffset> torque_offset(const Robot& robot, const BaseParameters& base, const Points& points);

}  // namespace deltadyn::gate
