#pragma once

/// \file
/// The parameters of a robot as rows of a file: nominal ones and fitted ones.

#include <utility>

#include "deltadyn/identification/identify.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"
#include "deltadyn/runtime/robot.hpp"

namespace deltadyn::tools {

/// Name and unit of every parameter of the robot, without values.
inline ParameterTable empty_table(const Robot& robot) {
  ParameterTable table;
  for (int k = 0; k < robot.parameters(); ++k) {
    ParameterEntry entry;
    entry.name = robot.parameter_names()[static_cast<std::size_t>(k)];
    entry.unit = robot.parameter_units()[static_cast<std::size_t>(k)];
    table.entries.push_back(std::move(entry));
  }
  return table;
}

inline ParameterTable parameter_table(const Robot& robot, const NominalParameters& nominal) {
  ParameterTable table = empty_table(robot);
  for (int k = 0; k < robot.parameters(); ++k) {
    ParameterEntry& entry = table.entries[static_cast<std::size_t>(k)];
    entry.value = nominal.value(k);
    entry.std = nominal.std(k);
  }
  return table;
}

/// "rad" or "m": of the displacement over which a joint's friction builds up. The telescope slides.
inline const char* presliding_unit(const RobotDescription& robot, int joint) {
  return joint < robot.drives() && robot.kind_of_drive(joint) == DriveKind::revolute ? "rad" : "m";
}

/// What a fit found, and the presliding of the joints that have one.
inline ParameterTable parameter_table(const Robot& robot, const Identification& result) {
  ParameterTable table = empty_table(robot);
  for (int k = 0; k < robot.parameters(); ++k) {
    ParameterEntry& entry = table.entries[static_cast<std::size_t>(k)];
    entry.value = result.fit.p(k);
    entry.std = result.fit.std(k);
    entry.prior = result.fit.prior(k);
    entry.data_share = result.fit.data_share(k);
  }
  for (std::size_t joint = 0; joint < result.presliding.size(); ++joint) {
    const PreslidingJoint& found = result.presliding[joint];
    if (!(found.displacement > 0)) continue;
    ParameterEntry entry;
    const auto at = static_cast<int>(joint);
    entry.name = presliding_name(robot.description(), at);
    entry.value = found.displacement;
    entry.std = found.std;
    entry.unit = presliding_unit(robot.description(), at);
    entry.data_share = 1;
    table.entries.push_back(std::move(entry));
  }
  return table;
}

}  // namespace deltadyn::tools
