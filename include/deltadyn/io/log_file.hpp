#pragma once

/// \file
/// Logs as CSV (see interfaces: `t_s, q1_rad, ..., tau1_Nm, ...`; prismatic drives: `q1_m, tau1_N`), and what
/// import_log.hpp reads.

#include <string>
#include <vector>

#include "deltadyn/runtime/robot_description.hpp"
#include "deltadyn/signal/log.hpp"
#include "deltadyn/signal/log_check.hpp"

namespace deltadyn {

struct LogReadOptions {
  bool need_torque = true;        ///< false: torque columns may be missing
  bool need_derivatives = false;  ///< true: qd and qdd columns of every drive must be there (as for --no-filter)
  bool check = true;              ///< run check_and_repair(); false leaves missing numbers as NaN in the log
  LogCheckOptions checks;
  std::string map;  ///< column map (column_map.hpp); empty: columns are known by their names
};

/// Reads a log of `robot`.
///
/// Columns in any order, unknown ones ignored. Positions q1_rad or q1_deg, rates qd1_rad_s, qd1_deg_s or qd1_rpm,
/// accelerations qdd1_rad_s2 or qdd1_deg_s2 (prismatic: q1_m, qd1_m_s, qdd1_m_s2), torques tau1_Nm (prismatic: tau1_N).
/// Result in SI units. qd and qdd are read only if they are there for every drive. An empty field, "nan" or "inf" is a
/// missing number; the check repairs or refuses it. A file of another form, or a map, goes through LogImport; the first
/// note then says what was taken for what. Throws Error(bad_input) with file, line and column.
[[nodiscard]] Log read_log(const std::string& path, const RobotDescription& robot, const LogReadOptions& options = {});

/// Like read_log(), but a log with gaps, or with several recordings in one file, comes as its parts
/// (check_and_split()). Without the check it is always one.
[[nodiscard]] std::vector<Log> read_log_parts(const std::string& path, const RobotDescription& robot,
                                              const LogReadOptions& options = {});

/// Writes t_s, q and, where the log has them, qd, qdd, tau, in SI units. Numbers read back exactly.
/// Throws Error(bad_input) if the disk is full; then nothing is left behind.
void write_log(const std::string& path, const Log& log, const RobotDescription& robot);

}  // namespace deltadyn
