#pragma once

/// \file
/// Lengths and places of a Delta-like robot.
///
/// Base frame W: origin in the plane of the arm axes, z up. Limb frame L of a limb: R_WL = Rz(azimuth) Rx(tilt), x
/// radially outwards, y the axis of a revolute drive. A drive angle of 0 puts the arm along x of L, and positive turns
/// it towards -z of L.

#include <Eigen/Core>

#include "deltadyn/core/rotation.hpp"
#include "deltadyn/model/topology.hpp"

namespace deltadyn {

/// One limb: a drive on the base, an upper arm or carriage, and a parallelogram of two struts.
template <class T>
struct LimbGeometry {
  T azimuth = T(0);                         ///< of the limb frame L about z of W [rad]
  T tilt = T(0);                            ///< of the limb frame L about its own x, after the azimuth [rad]
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

/// R_WL of a limb.
template <class T>
Matrix3<T> limb_frame(const LimbGeometry<T>& limb) {
  const SinCos<T> azimuth(limb.azimuth), tilt(limb.tilt);
  Matrix3<T> R_WL;
  R_WL << azimuth.cos, -azimuth.sin * tilt.cos, azimuth.sin * tilt.sin,  //
      azimuth.sin, azimuth.cos * tilt.cos, -azimuth.cos * tilt.sin,      //
      T(0), tilt.sin, tilt.cos;
  return R_WL;
}

/// Pose of one part of the plate as a function of (r, theta): offset = c + Rz(theta) a + theta b from r, orientation
/// Rz(turn + kappa theta).
template <class T>
struct PlatePart {
  Vector3<T> c = Vector3<T>::Zero();  ///< [m]
  Vector3<T> a = Vector3<T>::Zero();  ///< [m]
  Vector3<T> b = Vector3<T>::Zero();  ///< [m/rad]
  T kappa = T(0);                     ///< turns of the part a turn of theta; 0 for a part that only translates
  T turn = T(0);                      ///< of the part's frame at theta = 0 [rad]
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
  T yaw_ratio = T(1);    ///< psi = yaw_ratio theta: turns of the tool a turn of theta
  T theta_range = T(1);  ///< largest theta to either side [rad]
  /// The loops' determinant in the middle of the workspace of a plate that turns, see plate_mode(); its sign is the
  /// assembly mode
  T mode = T(0);
  TelescopeGeometry<T> telescope;
  Vector3<T> gravity = Vector3<T>(T(0), T(0), T(-9.81));  ///< in W [m/s^2]
};

}  // namespace deltadyn
