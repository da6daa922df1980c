#include "deltadyn/trajectory/task_columns.hpp"

#include "deltadyn/signal/log_columns.hpp"

namespace deltadyn {

std::vector<TaskColumns> task_columns(const RobotDescription& robot) {
  std::vector<TaskColumns> columns;
  for (int k = 0; k < robot.drives(); ++k) {
    TaskColumns column;
    if (robot.parts.empty()) {
      const DriveColumns drive = drive_columns(robot, k);
      column = {drive.q, drive.qd, drive.qdd, "q" + std::to_string(k + 1),
                robot.kind_of_drive(k) == DriveKind::revolute};
    } else {
      column.rotation = k >= 3;
      column.name = k < 3 ? std::string(1, "xyz"[k]) : "psi";
      const std::string unit = column.rotation ? "_rad" : "_m";
      column.z = column.name + unit;
      column.zd = column.name + "d" + unit + "_s";
      column.zdd = column.name + "dd" + unit + "_s2";
    }
    columns.push_back(column);
  }
  return columns;
}

}  // namespace deltadyn
