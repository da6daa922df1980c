#pragma once

/// \file
/// What an identification found beside the parameters of the regressor: how friction builds up after a reversal, ripple
/// of the torque.

#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <string>

#include "deltadyn/identification/identify.hpp"
#include "deltadyn/io/extra_rows.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/summary.hpp"

namespace deltadyn::tools {

inline bool joint_turns(const RobotDescription& robot, int joint) {
  return joint < robot.drives() && robot.kind_of_drive(joint) == DriveKind::revolute;
}

/// Rows for the parameter file.
inline void add_extra_rows(const RobotDescription& robot, const Identification& result, ParameterTable& table) {
  const auto add = [&table](const std::string& name, double value, double std, const char* unit) {
    ParameterEntry entry;
    entry.name = name;
    entry.value = value;
    entry.std = std;
    entry.unit = unit;
    entry.data_share = 1;
    table.entries.push_back(std::move(entry));
  };
  for (std::size_t joint = 0; joint < result.presliding.size(); ++joint) {
    const PreslidingJoint& found = result.presliding[joint];
    const auto at = static_cast<int>(joint);
    if (!(found.displacement > 0)) continue;
    add(presliding_name(robot, at), found.displacement, found.std, joint_turns(robot, at) ? "rad" : "m");
    if (found.damping_s > 0) add(presliding_damping_name(robot, at), found.damping_s, found.damping_std_s, "s");
  }
  for (ParameterEntry& row : ripple_rows(result.processing.ripples, robot)) table.entries.push_back(std::move(row));
}

/// The same in words, and the ripples' keys for the summary.
inline void tell_extra_rows(const RobotDescription& robot, const Identification& result, Summary& summary) {
  for (std::size_t joint = 0; joint < result.presliding.size(); ++joint) {
    const PreslidingJoint& found = result.presliding[joint];
    const auto at = static_cast<int>(joint);
    if (!(found.displacement > 0)) continue;
    const std::string damping = found.damping_s > 0 ? fmt::format(", bristles damped by {:.2g} +- {:.1g} ms",
                                                                  1e3 * found.damping_s, 1e3 * found.damping_std_s)
                                                    : std::string();
    fmt::print(
        "friction of {} builds up over {:.3g} +- {:.1g} {} after a reversal{}; its rows near reversals are used\n",
        at < robot.drives() ? fmt::format("drive {}", at + 1) : fmt::format("the {}", robot.inner_joint()),
        found.displacement, found.std, joint_turns(robot, at) ? "rad" : "m", damping);
  }
  std::vector<int> count(static_cast<std::size_t>(robot.drives()), 0);
  for (const Ripple& ripple : result.processing.ripples) {
    const bool turns = joint_turns(robot, ripple.drive);
    const double size = std::hypot(ripple.cosine, ripple.sine),
                 waves = turns ? ripple.n : ripple.n / (2 * std::numbers::pi);
    const double waves_std = turns ? ripple.n_std : ripple.n_std / (2 * std::numbers::pi);
    fmt::print(
        "torque of drive {} ripples by {:.3g} +- {:.1g} {} with {:.4g} +- {:.1g} waves a {}; the model holds that\n",
        ripple.drive + 1, size, ripple.amplitude_std, turns ? "N m" : "N", waves, waves_std, turns ? "turn" : "metre");
    const std::string key =
        fmt::format("ripple{}_drive{}", ++count[static_cast<std::size_t>(ripple.drive)], ripple.drive + 1);
    summary.add(key, size, turns ? "N*m" : "N");
    summary.add(key + "_std", ripple.amplitude_std, turns ? "N*m" : "N");
    summary.add(key + "_waves", waves, turns ? "1/turn" : "1/m");
  }
}

}  // namespace deltadyn::tools
