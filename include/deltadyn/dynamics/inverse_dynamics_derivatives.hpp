#pragma once

/// \file
/// Derivatives of the drive torques by the drive state, for optimal control and for sensitivities.
///
/// By qdd it is M(q); by qd, 2C(q, qd) plus the viscous friction, because C is of Christoffel symbols: both analytic.
/// By q the same templates run on dual numbers (forward differentiation, exact to rounding). No finite differences.

#include "deltadyn/core/dual.hpp"
#include "deltadyn/dynamics/equations_of_motion.hpp"
#include "deltadyn/model/cast_geometry.hpp"

namespace deltadyn {

/// Row: torque of a drive, column: coordinate of a drive.
template <class T, int N>
struct TorqueDerivatives {
  Matrix<T, N, N> by_q;    ///< [N m/rad | N/m]
  Matrix<T, N, N> by_qd;   ///< [N m s/rad | N s/m]
  Matrix<T, N, N> by_qdd;  ///< [kg m^2 | kg]
};

/// The posture of a neighbourhood: q with slopes 1, the plate with its Jacobian as slopes, and from there all else.
/// That way the closed loops are differentiated exactly without differentiating their solution.
template <class T, class Robot>
Status posture_with_slopes(const Geometry<Dual<T, Robot::kDrives>, Robot>& geometry, const Posture<T, Robot>& posture,
                           Posture<Dual<T, Robot::kDrives>, Robot>& with_slopes) {
  constexpr int N = Robot::kDrives;
  const Matrix<T, N, N> J = task_jacobian(posture);
  Vector<Dual<T, N>, N> q, z;
  for (int i = 0; i < N; ++i) {
    q(i) = Dual<T, N>(posture.q(i), Vector<T, N>::Unit(i));
    z(i) = Dual<T, N>(posture.z(i), J.row(i).transpose());
  }
  return assemble_posture(geometry, q, z, with_slopes);
}

/// Derivatives of inverse_dynamics() at a motion. Coulomb friction counts as constant, which it is away from a
/// reversal. The derivatives of forward dynamics follow: dqdd/dx = -M^-1 dtau/dx at the same accelerations, dqdd/dtau =
/// M^-1.
/// \return singular where the posture is; then the derivatives keep their values
template <class Layout, class T, class Robot>
Status inverse_dynamics_derivatives(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion,
                                    const Vector<T, Layout::kColumns>& p,
                                    TorqueDerivatives<T, Robot::kDrives>& derivatives) {
  constexpr int N = Robot::kDrives;
  using Number = Dual<T, N>;
  const auto with_slopes = cast_geometry<Number>(geometry);
  Motion<Number, Robot> nearby;
  const Status status = posture_with_slopes(with_slopes, motion.posture, nearby.posture);
  if (status != Status::ok) return status;
  set_drive_rates<Number, Robot>(with_slopes, motion.qd.template cast<Number>(), motion.qdd.template cast<Number>(),
                                 nearby);
  const Vector<Number, N> tau = inverse_dynamics<Layout, Number, Robot>(with_slopes, nearby, p.template cast<Number>());
  for (int i = 0; i < N; ++i) derivatives.by_q.row(i) = tau(i).slope.transpose();

  const EquationsOfMotion<T, N> terms = equations_of_motion<Layout>(geometry, motion, p);
  derivatives.by_qd = T(2) * terms.C;
  for (int joint = 0; joint < Layout::kFrictionJoints; ++joint) {
    const RowVector<T, N> J = friction_joint(motion, joint).J;
    derivatives.by_qd += p(Layout::viscous(joint)) * J.transpose().lazyProduct(J);
  }
  derivatives.by_qdd = terms.M;
  return Status::ok;
}

}  // namespace deltadyn
