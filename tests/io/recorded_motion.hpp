#pragma once

/// \file
/// One motion, to be written in the forms of many recorders.

#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <numbers>
#include <string>

#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn::testing_support {

inline constexpr int kMotionRows = 600;
inline constexpr double kDegrees = 180.0 / std::numbers::pi;

inline double position(double t) {
  return 0.8 * std::sin(9.0 * t) + 0.1;
}
inline double torque(double t) {
  return 3.0 * std::cos(9.0 * t) + 0.5;
}

/// A drive on its test bench.
inline RobotDescription one_drive(DriveKind kind = DriveKind::revolute) {
  RobotDescription robot;
  robot.name = "bench";
  robot.type = "axis";
  robot.drive_kind = kind;
  robot.limbs.resize(1);
  robot.limits.resize(1);
  return robot;
}

/// Several drives, for questions of order.
inline RobotDescription drives(int count) {
  RobotDescription robot = one_drive();
  robot.limbs.resize(static_cast<std::size_t>(count));
  robot.limits.resize(static_cast<std::size_t>(count));
  return robot;
}

/// `head`, then a line for each ms: `row(k, t)`.
inline std::string recorded(const std::string& head, const std::function<std::string(int, double)>& row,
                            int rows = kMotionRows) {
  std::string text = head;
  for (int k = 0; k < rows; ++k) text += row(k, 0.001 * k);
  return text;
}

}  // namespace deltadyn::testing_support
