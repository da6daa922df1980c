#pragma once

#include <string>

#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

/// "drive 2", as people count, with a space that does not break.
inline std::string drive_name(int drive) {
  return "drive\u00A0" + std::to_string(drive + 1);
}

/// The text with spaces that do not break.
inline std::string unbroken(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == ' ') {
      out += "\u00A0";
    } else {
      out += c;
    }
  }
  return out;
}

/// A body or joint in plain words, e.g. "lower part of the telescope bar", "drive 2".
inline std::string owner_in_words(const ParameterId& id) {
  if (id.kind != ParameterKind::inertial) return id.number > 0 ? drive_name(id.number - 1) : "sliding joint of the telescope bar";
  constexpr const char* kWords[] = {
      "upper arm", "strut", "platform", "tool", "upper part of the telescope bar", "lower part of the telescope bar"};  // of Body
  return kWords[static_cast<int>(id.body)] + (id.number > 0 ? "\u00A0" + std::to_string(id.number) : "");
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
template <class Strings>
std::string join_words(const Strings& words) {
  std::string text;
  std::size_t k = 0;
  for (const std::string& word : words) {
    if (k > 0) text += k + 1 == words.size() ? " and " : ", ";
    text += word;
    ++k;
  }
  return text;
}

}  // namespace deltadyn
