#pragma once

/// \file
/// Lengths and places of a Delta-like robot.
///
/// Base frame W: origin in the plane of the arm axes, z up. Limb frame L of a limb: R_WL = Rz(azimuth), x radially
/// outwards, y the axis of a revolute drive. A drive angle of 0 is horizontal outwards and positive turns the arm down.

#include <Eigen/Core>

#include "deltadyn/core/types.hpp"
#include "deltadyn/model/topology.hpp"

namespace deltadyn {

/// One limb: a drive on the base, an upper arm or carriage, and a parallelogram of two struts.
template <class T>
struct LimbGeometry {
  T azimuth = T(0);                         ///< of the limb frame L about z of W [rad]
  Vector3<T> p_WD = Vector3<T>::Zero();     ///< drive origin D from W, in W [m]
  Vector3<T> axis_L = Vector3<T>::UnitY();  ///< unit axis of the drive in L; revolute drives: always +y
  Vector3<T> p_DE_0 = Vector3<T>::Zero();   ///< elbow centre E from D at q = 0, in L [m]; revolute: (arm length, 0, 0)
  T strut = T(1);                           ///< strut length [m]
  T strut_spacing = T(0.1);                 ///< distance of the two struts of the limb, along y of L [m]
  Vector3<T> p_BA = Vector3<T>::Zero();     ///< attachment centre A from the origin B of the plate part, in W [m]
  int part = 0;                             ///< plate part that holds the attachment
  T elbow =
      /// +1: posture with the elbow outwards (revolute) or the carriage behind the plate along -axis; -1: the other one
      T(1);
};

/// Pose of one part of the plate as a function of (r, theta): offset = c + Rz(theta) a + theta b, orientation Rz(kappa
/// theta).
template <class T>
struct PlatePart {
  Vector3<T> c = Vector3<T>::Zero();
  Vector3<T> a = Vector3<T>::Zero();
  Vector3<T> b = Vector3<T>::Zero();
  T kappa = T(0);
};

/// Telescope bar: upper universal joint on the base, prismatic joint, lower universal joint on the plate.
template <class T>
struct TelescopeGeometry {
  Vector3<T> p_WU = Vector3<T>::Zero();  ///< centre U of the upper universal joint from W, in W [m]
  Vector3<T> p_BV = Vector3<T>::Zero();  ///< centre V of the lower universal joint from the plate centre B, in W [m]
};

/// All of a robot. Fixed size: usable in firmware.
template <class T, class Robot>
struct Geometry {
  LimbGeometry<T> limbs[Robot::kLimbs];
  PlatePart<T> parts[Robot::kPlateParts > 0 ? Robot::kPlateParts : 1];
  TelescopeGeometry<T> telescope;
  Vector3<T> gravity = Vector3<T>(T(0), T(0), T(-9.81));  ///< in W [m/s^2]
};

}  // namespace deltadyn
