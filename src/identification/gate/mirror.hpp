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

/// How the torques read with the yaw as given, and with position and torque of its drive turned.
struct Pairing {
  double rms = 0, rms_turned = 0;  ///< residual of the yaw's drive [N m]
  double margin =
      /// By how much chi^2 of that drive falls when the yaw is turned, for rows that are independent of one another
      0;
  double margin_of_all = 0;  ///< the same of all drives together
};

/// One fit of the base parameters to all drives for each reading, each drive weighted by its own residual. Nothing for
/// robots without a drive for the yaw, for few rows, and for poses out of reach.
[[nodiscard]] std::optional<Pairing> compare_pairings(const Robot& robot, const BaseParameters& base,
                                                      const Sample& sample);

/// A warning where the turned reading is clearly the better one.
[[nodiscard]] std::optional<LogFinding> mirror_finding(const Robot& robot, const BaseParameters& base,
                                                       const Sample& sample);

/// Whether an explanation turns position and torque of the yaw's drive and nothing else: the same as limbs numbered the
/// other way round.
[[nodiscard]] bool is_turned_yaw(const RobotDescription& robot, const Explanation& explanation);

}  // namespace deltadyn::gate
