#pragma once

#include <algorithm>
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

/// A body or joint in plain words, e.g. "lower part of the telescope bar" for telescope_lower, "drive 2" for drive2.
inline std::string owner_in_words(const std::string& owner) {
  if (owner.starts_with("telescope_upper")) return "upper part of the telescope bar";
  if (owner.starts_with("telescope_lower")) return "lower part of the telescope bar";
  if (owner == "telescope") return "sliding joint of the telescope bar";
  const auto digit = owner.find_last_not_of("0123456789") + 1;
  std::string name = owner.substr(0, digit);
  std::ranges::replace(name, '_', ' ');
  return digit < owner.size() ? name + "\u00A0" + owner.substr(digit) : name;
}

inline bool turns(const Robot& robot, int drive) {
  return robot.description().kind_of_drive(drive) == DriveKind::revolute;
}
inline const char* torque_unit_of(const Robot& robot, int drive) {
  return turns(robot, drive) ? "N m" : "N";
}
inline const char* position_unit_of(const Robot& robot, int drive) {
  return turns(robot, drive) ? "rad" : "m";
}
inline const char* velocity_unit_of(const Robot& robot, int drive) {
  return turns(robot, drive) ? "rad/s" : "m/s";
}
inline const char* acceleration_unit_of(const Robot& robot, int drive) {
  return turns(robot, drive) ? "rad/s²" : "m/s²";
}
/// "torque", or "force" of a drive that slides.
inline const char* effort_of(const Robot& robot, int drive) {
  return turns(robot, drive) ? "torque" : "force";
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
