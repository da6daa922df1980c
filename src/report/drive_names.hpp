#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <string>
#include <vector>

#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

/// "drive 2", as people count, with a space that does not break.
inline std::string drive_name(int drive) {
  return "drive\u00A0" + std::to_string(drive + 1);
}

/// The text with spaces that do not break.
inline std::string unbroken(std::string text) {
  for (auto at = text.find(' '); at != std::string::npos; at = text.find(' ', at)) text.replace(at, 1, "\u00A0");
  return text;
}

/// A body or joint in plain words, e.g. "lower part of the telescope bar", "drive 2".
inline std::string owner_in_words(const ParameterId& id) {
  if (id.kind != ParameterKind::inertial)
    return id.number > 0                       ? drive_name(id.number - 1)
           : id.inner == InnerJointKind::plate ? "joints of the plate"
                                               : "sliding joint of the telescope bar";
  constexpr const char* kWords[] = {
      // Of Body
      "upper arm",  "strut",   "platform", "tool", "upper part of the telescope bar", "lower part of the telescope bar",
      "half plate", "crossbar"};
  return kWords[static_cast<int>(id.body)] + (id.number > 0 ? "\u00A0" + std::to_string(id.number) : "");
}

inline bool turns(const Robot& robot, int drive) {
  return robot.description().kind_of_drive(drive) == DriveKind::revolute;
}
/// Units of a drive, and what it exerts.
struct DriveUnits {
  const char *torque, *position, *velocity, *acceleration, *effort;
};
inline const DriveUnits& units_of(const Robot& robot, int drive) {
  static constexpr DriveUnits kTurning{"N m", "rad", "rad/s", "rad/s²", "torque"};
  static constexpr DriveUnits kSliding{"N", "m", "m/s", "m/s²", "force"};
  return turns(robot, drive) ? kTurning : kSliding;
}

/// Unit of a mass matrix over the limbs' drives.
inline const char* inertia_unit_of(const Robot& robot) {
  return robot.description().drive_kind == DriveKind::revolute ? "kg m²" : "kg";
}

/// "a, b and c".
inline std::string join_words(const std::vector<std::string>& words) {
  if (words.size() < 2) return fmt::format("{}", fmt::join(words, ""));
  return fmt::format("{} and {}", fmt::join(words.begin(), words.end() - 1, ", "), words.back());
}

/// "1 log", "2 logs".
inline std::string counted(std::ptrdiff_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}
/// "delta4, 4 drives".
inline std::string robot_in_words(const RobotDescription& robot) {
  return fmt::format("{}, {}", robot.type, counted(robot.drives(), "drive"));
}

}  // namespace deltadyn
