#pragma once

/// \file
/// The parameters of a robot as rows of a file: nominal ones and fitted ones.

#include <utility>

#include "deltadyn/identification/identify.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "identified_extras.hpp"

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

/// What a fit found, with the presliding of the joints that have one and the ripples.
inline ParameterTable parameter_table(const Robot& robot, const Identification& result) {
  ParameterTable table = empty_table(robot);
  for (int k = 0; k < robot.parameters(); ++k) {
    ParameterEntry& entry = table.entries[static_cast<std::size_t>(k)];
    entry.value = result.fit.p(k);
    entry.std = result.fit.std(k);
    entry.prior = result.fit.prior(k);
    entry.data_share = result.fit.data_share(k);
  }
  add_extra_rows(robot.description(), result, table);
  return table;
}

}  // namespace deltadyn::tools
