#pragma once

/// \file
/// Parameter files: `name,value,unit` and, where known, `std,prior,data_share`.

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

/// One row. std, prior and data_share are NaN where the file does not give them.
struct ParameterEntry {
  std::string name;  ///< e.g. "upper_arm.m", "strut3.Ixx", "drive1.viscous"
  double value = 0.0;
  std::string unit;  ///< of value, std and prior, e.g. "kg*m^2"
  double std = std::numeric_limits<double>::quiet_NaN();
  double prior = std::numeric_limits<double>::quiet_NaN();
  double data_share = std::numeric_limits<double>::quiet_NaN();  ///< 0 from the prior, 1 from the data
  long line = 0;                                                 ///< in the file; 0 if not read from one
};

/// In place of the name of an effect file that was not written.
inline constexpr const char* kEffectsNotWritten = "not written";

struct ParameterTable {
  std::string file;    ///< where it came from, for messages
  std::string remark;  ///< one line, written as a comment above the header; not read back
  /// Effect file that the parameters were found with, from the working folder; empty: none. The comment
  /// `# effects: NAME` holds it relative to the parameter file, so that both may move together.
  std::string effects;
  std::vector<ParameterEntry> entries;

  /// Null if there is no such name.
  [[nodiscard]] const ParameterEntry* find(const std::string& name) const;
};

/// Throws Error(bad_input) with file, line and column: missing file, no rows, a name twice or empty, no number, a unit
/// that does not fit the name, a negative std, a data_share outside [0, 1].
[[nodiscard]] ParameterTable read_parameters(const std::string& path);

/// The same for a robot, in the numbers that one of its size can have: throws Error(bad_input) with the line for masses
/// in grams, moments in kg mm^2, negative masses or friction (runtime/plausibility.hpp).
[[nodiscard]] ParameterTable read_parameters(const std::string& path, const RobotDescription& robot);

/// What to tell somebody who uses the parameters without the effects that they were found with, and the flag that mends
/// it.
/// \param effects_given  the effect file that is given; empty: none
/// \return empty if nothing is missing
[[nodiscard]] std::string missing_effects(const ParameterTable& table, const std::string& effects_given);

/// Writes the table; the columns std, prior and data_share appear if any row has them. Numbers read back exactly.
/// Throws Error(bad_input) if the disk is full; then nothing is left behind.
void write_parameters(const std::string& path, const ParameterTable& table);

/// The wanted parameters in order, with what is worth telling.
struct ParameterMatch {
  Eigen::VectorXd value, std;         ///< std: NaN where not known
  Eigen::VectorXd prior;              ///< what the identification kept to; the value where the file has no prior
  std::vector<std::string> missing;   ///< wanted names that the table lacks; their value is 0
  std::vector<std::string> warnings;  ///< rows of the table that nobody wanted, with their line
};

/// Finds each name. A name of one limb ("upper_arm2.m", "strut3.Ixx") falls back on the shared name ("upper_arm.m").
/// \param units  unit of each name, e.g. of Robot::parameter_units(); if empty, only plausibility was checked on
///               reading
/// Throws Error(bad_input) if a unit differs, no name at all is found, a whole body is missing and one is of another
/// robot, or the table holds only the limbs' own values where the shared one is wanted.
[[nodiscard]] ParameterMatch match_parameters(const ParameterTable& table, const std::vector<std::string>& names,
                                              const std::vector<std::string>& units = {});

/// The columns that a parameter file was written for: limbs of their own, the tool, rotor inertias, offsets.
[[nodiscard]] ParameterOptions parameter_options_of(const ParameterTable& table, const RobotDescription& robot);

/// match_parameters(table, names, units).value
[[nodiscard]] Eigen::VectorXd values(const ParameterTable& table, const std::vector<std::string>& names,
                                     const std::vector<std::string>& units = {});

}  // namespace deltadyn
