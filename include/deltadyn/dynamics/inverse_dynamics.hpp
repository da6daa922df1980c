#pragma once

/// \file
/// tau = Y p without forming Y: the same recursion, with numbers instead of columns.

#include "deltadyn/dynamics/body_inertia.hpp"
#include "deltadyn/dynamics/regressor.hpp"

namespace deltadyn {

/// Friction [N m | N] of a joint against its own rate: paper (6), (7).
template <class Layout, class T>
T joint_friction(const Vector<T, Layout::kColumns>& p, int joint, const T& rate) {
  return p(Layout::viscous(joint)) * rate + p(Layout::coulomb(joint)) * sign_of(rate);
}

/// Drive torques [N m | N] that friction takes: f(qd) of (1).
template <class Layout, class T, class Robot>
Vector<T, Robot::kDrives> friction_torque(const Motion<T, Robot>& motion, const Vector<T, Layout::kColumns>& p) {
  Vector<T, Robot::kDrives> tau = Vector<T, Robot::kDrives>::Zero();
  for (int joint = 0; joint < Layout::kFrictionJoints; ++joint) {
    const auto f = friction_joint(motion, joint);
    tau += joint_friction<Layout>(p, joint, f.rate) * f.J.transpose();
  }
  return tau;
}

/// Adds the drive torques [N m | N] that the bodies take, gravity included.
template <class Layout, class T, class Robot>
void add_torque_of_bodies(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion,
                          const Vector<T, Layout::kColumns>& p, Vector<T, Robot::kDrives>& tau) {
  for_each_body(geometry, motion, [&](Body kind, int index, int count, const BodyMotion<T, Robot::kDrives>& body) {
    const BodyInertia<T> inertia = body_inertia<Layout, T>(p, kind, index);
    tau += T(count) * (body.J_v.transpose() * inertia.force(body) + body.J_w.transpose() * inertia.moment(body));
  });
}

/// Drive torques [N m | N] of a motion for parameters p (layout of the regressor). Paper (1), (2).
template <class Layout, class T, class Robot>
Vector<T, Robot::kDrives> inverse_dynamics(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion,
                                           const Vector<T, Layout::kColumns>& p) {
  Vector<T, Robot::kDrives> tau = friction_torque<Layout>(motion, p);
  add_torque_of_bodies<Layout>(geometry, motion, p, tau);
  for (int drive = 0; drive < Robot::kDrives; ++drive) {
    tau(drive) += p(Layout::kRotorInertia + drive) * motion.qdd(drive) + p(Layout::kOffset + drive);
  }
  return tau;
}

}  // namespace deltadyn
