#pragma once

/// \file
/// The equations of motion (1) term by term, M(q) qdd + C(q, qd) qd + g(q) + f(qd) = tau, in drive and in task
/// coordinates, and the energies that belong to them.

#include "deltadyn/dynamics/inverse_dynamics.hpp"
#include "deltadyn/dynamics/mass_matrix.hpp"

namespace deltadyn {

/// The terms of (1) at one state. In drive coordinates of units [N m | N] a drive; in task coordinates for zdd and a
/// force on the plate [N] and a moment about the vertical [N m].
template <class T, int N>
struct EquationsOfMotion {
  Matrix<T, N, N> M;  ///< symmetric; positive definite for physically consistent parameters
  Matrix<T, N, N> C;  ///< of the Christoffel symbols of M: C + C^T = Mdot, so Mdot - 2C is skew-symmetric
  Vector<T, N> g;     ///< gravity, the gradient of the potential energy
  Vector<T, N> f;     ///< friction of drives and inner joint, and the drives' offsets
};

/// The terms in drive coordinates. The accelerations of `motion` do not matter.
template <class Layout, class T, class Robot>
EquationsOfMotion<T, Robot::kDrives> equations_of_motion(const Geometry<T, Robot>& geometry,
                                                         const Motion<T, Robot>& motion,
                                                         const Vector<T, Layout::kColumns>& p) {
  constexpr int N = Robot::kDrives;
  EquationsOfMotion<T, N> terms;
  terms.M.setZero();
  terms.C.setZero();
  terms.g.setZero();
  terms.f = friction_torque<Layout>(motion, p) + p.template segment<N>(Layout::kOffset);
  for_each_body(geometry, motion, jacobian_rates(geometry, motion),
                [&](Body kind, int index, int count, const BodyState<T, N>& body) {
                  const BodyInertia<T> inertia = body_inertia<Layout, T>(p, kind, index);
                  terms.M += T(count) * inertia.mass_matrix(body);
                  terms.C += T(count) * inertia.coriolis_matrix(body);
                  terms.g += T(count) * inertia.gravity_torque(body, body.R_WB.transpose() * geometry.gravity);
                });
  complete_mass_matrix<Layout, T, N>(p, terms.M);
  return terms;
}

/// The same terms in task coordinates z: with J = dz/dq, M_z = J^-T M J^-1, C_z = J^-T (C - M J^-1 Jdot) J^-1, and J^-T
/// before g and f. What holds for M and C holds for M_z and C_z, too.
/// \return singular where a drive cannot follow the plate; then `task` keeps its values
template <class T, class Robot>
Status equations_in_task(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion,
                         const EquationsOfMotion<T, Robot::kDrives>& drives,
                         EquationsOfMotion<T, Robot::kDrives>& task) {
  constexpr int N = Robot::kDrives;
  Matrix<T, N, N> J_inverse;
  const Status status = drive_jacobian(geometry, motion.posture, J_inverse);
  if (status != Status::ok) return status;
  const Matrix<T, N, N> J_d = task_jacobian_rate(jacobian_rates(geometry, motion));
  const Matrix<T, N, N> transposed = J_inverse.transpose();
  const Matrix<T, N, N> half = transposed.lazyProduct(drives.M);
  const Matrix<T, N, N> turned = J_inverse.lazyProduct(J_d);
  const Matrix<T, N, N> C = drives.C - drives.M.lazyProduct(turned);
  task.M = half.lazyProduct(J_inverse);
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < i; ++j) task.M(i, j) = task.M(j, i);
  }
  task.C = Matrix<T, N, N>(transposed.lazyProduct(C)).lazyProduct(J_inverse);
  task.g = transposed.lazyProduct(drives.g);
  task.f = transposed.lazyProduct(drives.f);
  return Status::ok;
}

/// Kinetic energy [J] of bodies and rotors.
template <class Layout, class T, class Robot>
T kinetic_energy(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion,
                 const Vector<T, Layout::kColumns>& p) {
  T energy = T(0);
  for_each_body(geometry, motion, [&](Body kind, int index, int count, const BodyMotion<T, Robot::kDrives>& body) {
    const BodyInertia<T> inertia = body_inertia<Layout, T>(p, kind, index);
    const Vector3<T> v = body.J_v.lazyProduct(motion.qd);
    energy += T(count) * (T(0.5) * inertia.m * v.squaredNorm() + v.dot(body.w.cross(inertia.mc)) +
                          T(0.5) * body.w.dot(inertia.I.lazyProduct(body.w)));
  });
  for (int drive = 0; drive < Robot::kDrives; ++drive) {
    energy += T(0.5) * p(Layout::kRotorInertia + drive) * motion.qd(drive) * motion.qd(drive);
  }
  return energy;
}

/// Potential energy [J] of the bodies under gravity, zero for a mass at the origin of W.
template <class Layout, class T, class Robot>
T potential_energy(const Geometry<T, Robot>& geometry, const Posture<T, Robot>& posture,
                   const Vector<T, Layout::kColumns>& p) {
  Motion<T, Robot> at_rest;
  at_rest.posture = posture;
  T energy = T(0);
  for_each_body(geometry, at_rest, JacobianRates<T, Robot>(),
                [&](Body kind, int index, int count, const BodyState<T, Robot::kDrives>& body) {
                  const BodyInertia<T> inertia = body_inertia<Layout, T>(p, kind, index);
                  energy -= T(count) * geometry.gravity.dot(inertia.m * body.p_WB + body.R_WB * inertia.mc);
                });
  return energy;
}

}  // namespace deltadyn
