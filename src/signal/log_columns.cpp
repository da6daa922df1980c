#include "deltadyn/signal/log_columns.hpp"

namespace deltadyn {

DriveColumns drive_columns(const RobotDescription& robot, int drive) {
  const std::string number = std::to_string(drive + 1);
  const bool turns = robot.kind_of_drive(drive) == DriveKind::revolute;
  const std::string length = turns ? "_rad" : "_m";
  return {"q" + number + length, "qd" + number + length + "_s", "qdd" + number + length + "_s2",
          "tau" + number + (turns ? "_Nm" : "_N")};
}

}  // namespace deltadyn
