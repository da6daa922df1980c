#pragma once

/// \file
/// tau = Y p without forming Y: the same recursion, with numbers instead of columns.

#include "deltadyn/dynamics/regressor.hpp"

namespace deltadyn {

/// Drive torques [N m | N] of a motion for parameters p (layout of the regressor). Paper (1), (2).
template <class Layout, class T, class Robot>
Vector<T, Robot::kDrives> inverse_dynamics(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion,
                                           const Vector<T, Layout::kColumns>& p) {
  Vector<T, Robot::kDrives> tau = Vector<T, Robot::kDrives>::Zero();
  for_each_body(geometry, motion, [&](Body kind, int index, int count, const BodyMotion<T, Robot::kDrives>& body) {
    const auto b = p.template segment<kInertialParameters>(kInertialParameters * Layout::body(kind, index));
    const Vector3<T> mc = b.template segment<3>(1);
    const auto inertia_times = [&b](const Vector3<T>& v) {
      return Vector3<T>(b(4) * v.x() + b(7) * v.y() + b(9) * v.z(), b(7) * v.x() + b(5) * v.y() + b(8) * v.z(),
                        b(9) * v.x() + b(8) * v.y() + b(6) * v.z());
    };
    const Vector3<T> force = b(0) * body.a + body.w_d.cross(mc) + body.w.cross(body.w.cross(mc));
    const Vector3<T> moment = inertia_times(body.w_d) + body.w.cross(inertia_times(body.w)) + mc.cross(body.a);
    tau += T(count) * (body.J_v.transpose() * force + body.J_w.transpose() * moment);
  });
  for (int joint = 0; joint < Layout::kFrictionJoints; ++joint) {
    const auto f = friction_joint(motion, joint);
    tau += (p(Layout::viscous(joint)) * viscous_friction(f.rate) + p(Layout::coulomb(joint)) * coulomb_friction(f.rate)) *
           f.J.transpose();
  }
  for (int drive = 0; drive < Robot::kDrives; ++drive) {
    tau(drive) +=
        p(Layout::kRotorInertia + drive) * rotor_inertia(motion.qdd(drive)) + p(Layout::kOffset + drive) * torque_offset<T>();
  }
  return tau;
}

}  // namespace deltadyn
