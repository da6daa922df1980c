#pragma once

#include "deltadyn/core/rotation.hpp"
#include "deltadyn/kinematics/forward.hpp"
#include "deltadyn/model/robot_types.hpp"

namespace deltadyn::firmware_gate {

/// A robot about the size of the paper's, not its exact lengths.
template <class T, class Robot>
Geometry<T, Robot> plausible_geometry() {
  Geometry<T, Robot> geometry;
  if constexpr (Robot::kPlateTurns) {
    // A Par4 in numbers, as a converted header has it: nothing is to be worked out in double.
    const T side[] = {T(1), T(-1)};
    for (int k = 0; k < 2; ++k) {
      geometry.parts[k].a = Vector3<T>(T(0), side[k] * T(0.02), T(0));
      geometry.parts[2 + k].c = Vector3<T>(side[k] * T(0.03), T(0), T(0));
      geometry.parts[2 + k].kappa = T(1);
    }
    geometry.parts[4].kappa = geometry.yaw_ratio = T(2);
  }
  for (int i = 0; i < Robot::kLimbs; ++i) {
    LimbGeometry<T>& limb = geometry.limbs[i];
    limb.azimuth = Robot::kLimbs == 4 ? (T(i) + T(0.5)) * T(1.5707963267948966) : T(i) * T(2.0943951023931953);
    limb.part = Robot::kLimbs == 4 && i >= 2 ? 1 : 0;
    const Matrix3<T> R_WL = rot_z(SinCos<T>(limb.azimuth));
    limb.p_BA = R_WL * Vector3<T>(T(0.045), T(0), T(0));
    limb.strut = T(0.8);
    if (Robot::kDrive == DriveKind::revolute) {
      limb.p_WD = R_WL * Vector3<T>(T(0.2), T(0), T(0));
      limb.p_DE_0 = Vector3<T>(T(0.35), T(0), T(0));
    } else {
      limb.p_WD = R_WL * Vector3<T>(T(0.4), T(0), T(0));
      limb.axis_L = -Vector3<T>::UnitZ();
    }
  }
  geometry.telescope.p_BV = Vector3<T>(T(0), T(0), T(0.02));
  if constexpr (Robot::kPlateTurns) geometry.mode = plate_mode(geometry);
  return geometry;
}

}  // namespace deltadyn::firmware_gate
