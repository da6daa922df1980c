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

/// h4, i4 or par4, limbs in the diagonals. About the size of the published ones; a Par4 with its tool on half plate 1.
inline RobotDescription four_limb_description(const std::string& type, DriveKind kind = DriveKind::revolute) {
  RobotDescription robot;
  robot.name = type;
  robot.type = type;
  robot.drive_kind = kind;
  PlateShape plate;
  plate.spacing = type == "i4" ? 0 : 0.12;
  plate.bar_spacing = type == "par4" ? 0.07 : 0;
  plate.pinion_radius = type == "i4" ? 0.035 : 0;
  plate.ratio = type == "par4" ? 4 : 1;
  plate.tool = type == "par4" ? ToolPlace::half_plate : ToolPlace::centre;
  plate.range = type == "i4" ? 2.0 : 0.9;
  robot.set_plate(plate);
  for (int i = 0; i < 4; ++i) {
    LimbGeometry<double> limb;
    limb.azimuth = (i + 0.5) * 1.5707963267948966;
    limb.part = i < 2 ? 0 : 1;
    const Matrix3<double> R_WL = rot_z(SinCos<double>(limb.azimuth));
    const bool rails = kind == DriveKind::prismatic;
    limb.p_WD = R_WL * Vector3<double>(rails ? 0.45 : 0.2, 0, 0);
    limb.p_BA = R_WL * Vector3<double>(0.09, 0, 0) - robot.parts[static_cast<std::size_t>(limb.part)].a;
    limb.strut = rails ? 0.75 : 0.8;
    if (rails) {
      limb.axis_L = -Vector3<double>::UnitZ();
    } else {
      limb.p_DE_0 = Vector3<double>(0.35, 0, 0);
    }
    robot.limbs.push_back(limb);
    robot.limits.emplace_back();
  }
  return robot;
}

inline RobotDescription description_of(const std::string& type) {
  return type == "h4" || type == "i4" || type == "par4" ? four_limb_description(type) : delta_description(type);
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
