#pragma once

/// \file
/// Hypothesis: the limbs are numbered clockwise, or the fourth drive counts clockwise, but not both. Mirrored as a
/// whole a machine moves by the same equations; mirrored in part it is hardly another one, as only the tool's unbalance
/// and the joints of the telescope bar know left from right.

#include <optional>

#include "deltadyn/signal/log_finding.hpp"

#include "judge.hpp"
#include "rows.hpp"

namespace deltadyn::gate {

/// A warning where the torques read clearly better with position and torque of the yaw's drive turned: one fit of the
/// base parameters to all drives for each reading, each drive weighted by its own residual. Nothing for robots without
/// a drive for the yaw, for few rows, and for poses out of reach.
[[nodiscard]] std::optional<LogFinding> mirror_finding(const Robot& robot, const BaseParameters& base,
                                                       const Sample& sample);

/// Whether an explanation turns position and torque of the yaw's drive and nothing else: the same as limbs numbered the
/// other way round.
[[nodiscard]] bool is_turned_yaw(const RobotDescription& robot, const Explanation& explanation);

}  // namespace deltadyn::gate
