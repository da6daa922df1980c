#pragma once

/// \file
/// Velocities and accelerations of a posture: the Jacobians' rates, applied.

#include "deltadyn/kinematics/forward.hpp"
#include "deltadyn/kinematics/inverse.hpp"
#include "deltadyn/kinematics/posture.hpp"

namespace deltadyn {

template <class T>
struct LimbMotion {
  T beta_d = T(0), gamma_d = T(0), beta_dd = T(0), gamma_dd = T(0);  ///< strut angle rates [rad/s, rad/s^2]
};

template <class T>
struct TelescopeMotion {
  T a_d = T(0), b_d = T(0), length_d = T(0);     ///< [rad/s, m/s]
  T a_dd = T(0), b_dd = T(0), length_dd = T(0);  ///< [rad/s^2, m/s^2]
};

template <class T, class Robot>
struct Motion {
  static constexpr int N = Robot::kDrives;
  Posture<T, Robot> posture;
  Vector<T, N> qd = Vector<T, N>::Zero(), qdd = Vector<T, N>::Zero();
  Vector<T, N> zd = Vector<T, N>::Zero(), zdd = Vector<T, N>::Zero();
  LimbMotion<T> limbs[Robot::kLimbs];
  TelescopeMotion<T> telescope;
};

/// Fills all rates of `motion` from its posture, qd and qdd. Cannot fail: the posture is regular.
template <class T, class Robot>
void set_drive_rates(const Geometry<T, Robot>& geometry, const Vector<T, Robot::kDrives>& qd,
                     const Vector<T, Robot::kDrives>& qdd, Motion<T, Robot>& motion);

/// Motion of a drive state (q, qd, qdd).
/// \return out_of_range if a number is not finite, else the status of the forward kinematics
template <class T, class Robot>
Status motion_from_drives(const Geometry<T, Robot>& geometry, const Vector<T, Robot::kDrives>& q,
                          const Vector<T, Robot::kDrives>& qd, const Vector<T, Robot::kDrives>& qdd,
                          Motion<T, Robot>& motion) {
  if (!qd.allFinite() || !qdd.allFinite()) return Status::out_of_range;
  const Status status = posture_from_drives(geometry, q, motion.posture);
  if (status != Status::ok) return status;
  set_drive_rates(geometry, qd, qdd, motion);
  return Status::ok;
}

/// Drive rates of a task-space motion at a posture: dz/dq qd = zd and its derivative.
/// \return singular where a drive cannot follow the plate
template <class T, class Robot>
Status drive_rates(const Geometry<T, Robot>& geometry, const Posture<T, Robot>& posture,
                   const Vector<T, Robot::kDrives>& zd, const Vector<T, Robot::kDrives>& zdd,
                   Vector<T, Robot::kDrives>& qd, Vector<T, Robot::kDrives>& qdd);

/// Motion of a task-space state (z, zd, zdd).
/// \return out_of_range if a number is not finite, else the status of the inverse kinematics or of drive_rates
template <class T, class Robot>
Status motion_from_task(const Geometry<T, Robot>& geometry, const Vector<T, Robot::kDrives>& z,
                        const Vector<T, Robot::kDrives>& zd, const Vector<T, Robot::kDrives>& zdd,
                        Motion<T, Robot>& motion) {
  if (!zd.allFinite() || !zdd.allFinite()) return Status::out_of_range;
  Vector<T, Robot::kDrives> q, qd, qdd;
  Status status = inverse_kinematics(geometry, z, q);
  if (status == Status::ok) status = assemble_posture(geometry, q, z, motion.posture);
  if (status == Status::ok) status = drive_rates(geometry, motion.posture, zd, zdd, qd, qdd);
  if (status == Status::ok) set_drive_rates(geometry, qd, qdd, motion);
  return status;
}

/// dz/dq, N x N.
template <class T, class Robot>
Matrix<T, Robot::kDrives, Robot::kDrives> task_jacobian(const Posture<T, Robot>& posture) {
  Matrix<T, Robot::kDrives, Robot::kDrives> J = Matrix<T, Robot::kDrives, Robot::kDrives>::Identity();
  constexpr int P = kPlateCoordinates<Robot>;
  if constexpr (P > 0) J.template topRows<P>() = posture.J_plate;
  return J;
}

/// dq/dz, N x N, the inverse of task_jacobian().
/// \return singular where a drive cannot follow the plate
template <class T, class Robot>
Status drive_jacobian(const Geometry<T, Robot>& geometry, const Posture<T, Robot>& posture,
                      Matrix<T, Robot::kDrives, Robot::kDrives>& J) {
  J.setIdentity();
  if constexpr (kHasPlate<Robot>) {
    for (int column = 0; column < Robot::kDrives; ++column) {
      using Drives = Vector<T, Robot::kDrives>;
      Drives qd, qdd;
      const Status status = drive_rates<T, Robot>(geometry, posture, Drives::Unit(column), Drives::Zero(), qd, qdd);
      if (status != Status::ok) return status;
      J.col(column) = qd;
    }
  }
  return Status::ok;
}

}  // namespace deltadyn

#include "deltadyn/kinematics/motion.hxx"
