#pragma once

/// \file
/// Symmetric robots as data.

#include <string>

#include "deltadyn/core/rotation.hpp"
#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn::testing_support {

struct Lengths {
  double base_radius = 0.2, platform_radius = 0.05, upper_arm = 0.525, strut = 1.106, strut_spacing = 0.1;
};

/// delta3, linear-delta3 or delta4. Limb 1 on +x; carriages of linear drives run down.
inline RobotDescription delta_description(const std::string& type, const Lengths& lengths = {}) {
  RobotDescription robot;
  robot.name = type;
  robot.type = type;
  robot.drive_kind = type == "linear-delta3" ? DriveKind::prismatic : DriveKind::revolute;
  for (int i = 0; i < 3; ++i) {
    LimbGeometry<double> limb;
    limb.azimuth = i * 2.0943951023931953;
    const Matrix3<double> R_WL = rot_z(SinCos<double>(limb.azimuth));
    limb.p_WD = R_WL * Vector3<double>(lengths.base_radius, 0, 0);
    limb.p_BA = R_WL * Vector3<double>(lengths.platform_radius, 0, 0);
    limb.strut = lengths.strut;
    limb.strut_spacing = lengths.strut_spacing;
    if (robot.drive_kind == DriveKind::prismatic) {
      limb.axis_L = -Vector3<double>::UnitZ();
    } else {
      limb.p_DE_0 = Vector3<double>(lengths.upper_arm, 0, 0);
    }
    robot.limbs.push_back(limb);
    robot.limits.emplace_back();
  }
  robot.parts.emplace_back();
  if (type == "delta4") {
    robot.telescope.emplace();
    robot.limits.emplace_back();
  }
  return robot;
}

inline RobotDescription axis_description(DriveKind kind) {
  RobotDescription robot;
  robot.name = "axis";
  robot.type = "axis";
  robot.drive_kind = kind;
  robot.limbs.emplace_back();
  if (kind == DriveKind::prismatic) robot.limbs[0].axis_L = Vector3<double>::UnitX();
  robot.limits.emplace_back();
  return robot;
}

}  // namespace deltadyn::testing_support
