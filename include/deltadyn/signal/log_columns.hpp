#pragma once

/// \file
/// Names of the SI columns of a log.

#include <string>

#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn {

/// "q1_rad", "qd1_rad_s", "qdd1_rad_s2", "tau1_Nm"; for a prismatic drive "q1_m", "qd1_m_s", "qdd1_m_s2", "tau1_N".
struct DriveColumns {
  std::string q, qd, qdd, tau;
};

/// \param drive  0 is the first drive, whose columns carry the number 1
[[nodiscard]] DriveColumns drive_columns(const RobotDescription& robot, int drive);

}  // namespace deltadyn
