#pragma once

/// \file
/// Forward dynamics: drive accelerations for drive torques, (1) solved for qdd by Cholesky's factorisation of M.

#include <Eigen/Cholesky>

#include "deltadyn/dynamics/inverse_dynamics.hpp"
#include "deltadyn/dynamics/mass_matrix.hpp"

namespace deltadyn {

/// (1) at one state as M qdd + bias = tau: M(q), and bias = C qd + g + f + offsets [N m | N], in one pass over the
/// bodies.
template <class Layout, class T, class Robot>
void mass_and_bias(const Geometry<T, Robot>& geometry, const Posture<T, Robot>& posture,
                   const Vector<T, Robot::kDrives>& qd, const Vector<T, Layout::kColumns>& p,
                   Matrix<T, Robot::kDrives, Robot::kDrives>& M, Vector<T, Robot::kDrives>& bias) {
  constexpr int N = Robot::kDrives;
  Motion<T, Robot> motion;
  motion.posture = posture;
  set_drive_rates<T, Robot>(geometry, qd, Vector<T, N>::Zero(), motion);
  M.setZero();
  bias = friction_torque<Layout>(motion, p) + p.template segment<N>(Layout::kOffset);
  for_each_body(geometry, motion, [&](Body kind, int index, int count, const BodyMotion<T, N>& body) {
    const BodyInertia<T> inertia = body_inertia<Layout, T>(p, kind, index);
    M += T(count) * inertia.mass_matrix(body);
    bias += T(count) * (body.J_v.transpose() * inertia.force(body) + body.J_w.transpose() * inertia.moment(body));
  });
  complete_mass_matrix<Layout, T, N>(p, M);
}

/// qdd [rad/s^2 | m/s^2] of the drive torques tau [N m | N] at a posture with drive rates qd.
/// At rest Coulomb's law gives no torque here (sign(0) = 0); who simulates stiction adds it.
/// \return out_of_range where M is not positive definite: then the parameters are not physically consistent. qdd keeps
///         its value.
template <class Layout, class T, class Robot>
Status forward_dynamics(const Geometry<T, Robot>& geometry, const Posture<T, Robot>& posture,
                        const Vector<T, Robot::kDrives>& qd, const Vector<T, Robot::kDrives>& tau,
                        const Vector<T, Layout::kColumns>& p, Vector<T, Robot::kDrives>& qdd) {
  constexpr int N = Robot::kDrives;
  if (!qd.allFinite() || !tau.allFinite()) return Status::out_of_range;
  Matrix<T, N, N> M;
  Vector<T, N> bias;
  mass_and_bias<Layout, T, Robot>(geometry, posture, qd, p, M, bias);
  const Eigen::LLT<Matrix<T, N, N>> cholesky(M);
  if (cholesky.info() != Eigen::Success) return Status::out_of_range;
  qdd = cholesky.solve(Vector<T, N>(tau - bias));
  return Status::ok;
}

}  // namespace deltadyn
