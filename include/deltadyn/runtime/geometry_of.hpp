#pragma once

/// \file
/// From the run-time description to the types and the fixed-size geometry of the core.

#include "deltadyn/kinematics/forward.hpp"
#include "deltadyn/model/cast_geometry.hpp"
#include "deltadyn/model/robot_types.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn {

/// Fixed-size geometry in scalar T of a description that belongs to type Robot (its counts must match).
template <class T, class Robot>
Geometry<T, Robot> geometry_of(const RobotDescription& description) {
  Geometry<double, Robot> geometry;
  for (int i = 0; i < Robot::kLimbs; ++i) geometry.limbs[i] = description.limbs[static_cast<std::size_t>(i)];
  for (int k = 0; k < Robot::kPlateParts; ++k) geometry.parts[k] = description.parts[static_cast<std::size_t>(k)];
  if (description.telescope) geometry.telescope = *description.telescope;
  geometry.gravity = description.gravity;
  if constexpr (Robot::kPlateTurns) {
    geometry.yaw_ratio = description.plate->ratio;
    geometry.theta_range = description.plate->range;
    geometry.mode = plate_mode(geometry);
  }
  return cast_geometry<T>(geometry);
}

/// The names of all types, once each: "delta3, linear-delta3, ..."
[[nodiscard]] std::string robot_type_names();
/// Of those with an articulated plate.
[[nodiscard]] std::string articulated_type_names();

/// work(R()) with the type R of the core that the description belongs to. Throws Error(bad_input) if there is none.
template <class Work>
auto with_robot_type(const RobotDescription& robot, const Work& work) {
  using Result = decltype(work(Axis()));
  return visit_robot_type(robot.type, robot.drive_kind, work, [&]() -> Result {
    throw Error("robot type '" + robot.type + "' is not known", robot.name, "use one of " + robot_type_names());
  });
}

}  // namespace deltadyn
