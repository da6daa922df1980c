#pragma once

/// \file
/// Inverse kinematics q = f_IK(z) in closed form (paper III.A).

#include <cmath>

#include "deltadyn/kinematics/posture.hpp"

namespace deltadyn {

/// Angle of a revolute drive that puts the elbow at strut length from the attachment. With d = p_DE_0 and p = p_DA in
/// L: Ry(q) d . p = k, i.e. rho cos(q - phi) = k; elbow = +1 takes the arm turned less far down.
/// \return unreachable if no angle does it
template <class T>
Status revolute_drive_angle(const LimbGeometry<T>& limb, const Vector3<T>& p_DA, T& q) {
  using std::acos;
  using std::atan2;
  using std::sqrt;
  const Vector3<T>& d = limb.p_DE_0;
  const T along = d.x() * p_DA.x() + d.z() * p_DA.z();
  const T across = d.z() * p_DA.x() - d.x() * p_DA.z();
  const T rho = sqrt(along * along + across * across);
  const T k = (p_DA.squaredNorm() + d.squaredNorm() - limb.strut * limb.strut) / T(2) - d.y() * p_DA.y();
  if (!(k <= rho && k >= -rho) || !(rho > T(0))) return Status::unreachable;
  constexpr double kPi = 3.14159265358979323846;
  q = atan2(across, along) - limb.elbow * acos(k / rho);
  if (q <= T(-kPi)) q += T(2 * kPi);
  if (q > T(kPi)) q -= T(2 * kPi);
  return Status::ok;
}

/// Position of a prismatic drive: |p_DA - p_DE_0 - q axis| = strut; elbow = +1 takes the carriage behind the plate
/// along the axis.
template <class T>
Status prismatic_drive_position(const LimbGeometry<T>& limb, const Vector3<T>& p_DA, T& q) {
  using std::sqrt;
  const Vector3<T> w = p_DA - limb.p_DE_0;
  const T along = w.dot(limb.axis_L);
  const T square = along * along - w.squaredNorm() + limb.strut * limb.strut;
  if (!(square >= T(0))) return Status::unreachable;
  q = along - limb.elbow * sqrt(square);
  return Status::ok;
}

/// Drive coordinates of the task coordinates z = (r, psi); an axis has z = q.
template <class T, class Robot>
Status inverse_kinematics(const Geometry<T, Robot>& geometry, const Vector<T, Robot::kDrives>& z,
                          Vector<T, Robot::kDrives>& q) {
  if (!z.allFinite()) return Status::out_of_range;
  q = z;
  if constexpr (kHasPlate<Robot>) {
    const T psi = Robot::kPlateTurns ? z(kPlateCoordinates<Robot> - 1) : T(0);
    const Attachments<T, Robot> attachments(geometry, psi);
    for (int i = 0; i < Robot::kLimbs; ++i) {
      const LimbGeometry<T>& limb = geometry.limbs[i];
      const Vector3<T> p_DA = limb_frame(limb).transpose() * (z.template head<3>() + attachments(i).value - limb.p_WD);
      const Status status = Robot::kDrive == DriveKind::revolute ? revolute_drive_angle(limb, p_DA, q(i))
                                                                 : prismatic_drive_position(limb, p_DA, q(i));
      if (status != Status::ok) return status;
    }
  }
  return Status::ok;
}

}  // namespace deltadyn
