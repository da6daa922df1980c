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
[[nodiscard]] inline DriveColumns drive_columns(const RobotDescription& robot, int drive) {
  const std::string number = std::to_string(drive + 1);
  const bool turns = robot.kind_of_drive(drive) == DriveKind::revolute;
  const std::string length = turns ? "_rad" : "_m";
  return {"q" + number + length, "qd" + number + length + "_s", "qdd" + number + length + "_s2",
          "tau" + number + (turns ? "_Nm" : "_N")};
}

}  // namespace deltadyn
