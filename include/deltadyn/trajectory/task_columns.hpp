#pragma once

/// \file
/// Names of the task-space columns of a trajectory, with their units.

#include <string>
#include <vector>

#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn {

/// "x_m", "xd_m_s", "xdd_m_s2"; the telescope's angle: "psi_rad", "psid_rad_s", "psidd_rad_s2".
struct TaskColumns {
  std::string z, zd, zdd;
  std::string name;       ///< "x", "y", "z", "psi"; for an axis "q1"
  bool rotation = false;  ///< an angle, else a length
};

/// One entry a task coordinate. An axis has its drive's coordinate for task coordinate, so the names are those of the
/// drive.
[[nodiscard]] std::vector<TaskColumns> task_columns(const RobotDescription& robot);

}  // namespace deltadyn
