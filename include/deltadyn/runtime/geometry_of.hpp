#pragma once

/// \file
/// From the run-time description to the types and the fixed-size geometry of the core.

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn {

/// Fixed-size geometry in scalar T of a description that belongs to type Robot (its counts must match).
template <class T, class Robot>
Geometry<T, Robot> geometry_of(const RobotDescription& description) {
  Geometry<T, Robot> geometry;
  for (int i = 0; i < Robot::kLimbs; ++i) {
    const LimbGeometry<double>& from = description.limbs[static_cast<std::size_t>(i)];
    LimbGeometry<T>& to = geometry.limbs[i];
    to.azimuth = static_cast<T>(from.azimuth);
    to.p_WD = from.p_WD.cast<T>();
    to.axis_L = from.axis_L.cast<T>();
    to.p_DE_0 = from.p_DE_0.cast<T>();
    to.strut = static_cast<T>(from.strut);
    to.strut_spacing = static_cast<T>(from.strut_spacing);
    to.p_BA = from.p_BA.cast<T>();
    to.part = from.part;
    to.elbow = static_cast<T>(from.elbow);
  }
  for (int k = 0; k < Robot::kPlateParts; ++k) {
    const PlatePart<double>& from = description.parts[static_cast<std::size_t>(k)];
    geometry.parts[k] = {from.c.cast<T>(), from.a.cast<T>(), from.b.cast<T>(), static_cast<T>(from.kappa)};
  }
  if constexpr (Robot::kTelescope) {
    geometry.telescope.p_WU = description.telescope->p_WU.cast<T>();
    geometry.telescope.p_BV = description.telescope->p_BV.cast<T>();
  }
  geometry.gravity = description.gravity.cast<T>();
  return geometry;
}

/// work(R()) with the type R of the core that the description belongs to. Throws Error(bad_input) if there is none.
template <class Work>
auto with_robot_type(const RobotDescription& robot, const Work& work) {
  if (robot.type == Delta3::kName) return work(Delta3());
  if (robot.type == LinearDelta3::kName) return work(LinearDelta3());
  if (robot.type == Delta4::kName) return work(Delta4());
  if (robot.type == Axis::kName && robot.drive_kind == DriveKind::prismatic) return work(LinearAxis());
  if (robot.type == Axis::kName) return work(Axis());
  throw Error("robot type '" + robot.type + "' is not known", robot.name,
              "use one of delta3, linear-delta3, delta4, axis");
}

}  // namespace deltadyn
