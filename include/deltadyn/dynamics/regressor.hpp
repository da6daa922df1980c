#pragma once

/// \file
/// The complete regressor Y(q, qd, qdd) of paper (2)-(7): tau = Y p, linear in inertial and friction parameters.

#include "deltadyn/core/sign.hpp"
#include "deltadyn/kinematics/body_motion.hpp"
#include "deltadyn/kinematics/inner_joint.hpp"
#include "deltadyn/model/parameter_layout.hpp"

namespace deltadyn {

/// Force on a body [N] in its frame as F p, p the ten parameters (4): F is 3 x 10.
template <class T, int N>
Matrix<T, 3, kInertialParameters> force_regressor(const BodyMotion<T, N>& body);

/// Moment about the body frame's origin [N m] as F p: 3 x 10.
template <class T, int N>
Matrix<T, 3, kInertialParameters> moment_regressor(const BodyMotion<T, N>& body);

/// Y of a motion, drives x Layout::kColumns. Every entry is written.
template <class Layout, class T, class Robot>
void regressor(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion,
               Matrix<T, Robot::kDrives, Layout::kColumns>& Y);

/// Rates of the joints with friction and their partial derivatives by qd: drives, then the inner joint.
template <class T, class Robot>
struct FrictionJoint {
  T rate;
  RowVector<T, Robot::kDrives> J;
};
template <class T, class Robot>
FrictionJoint<T, Robot> friction_joint(const Motion<T, Robot>& motion, int joint);

}  // namespace deltadyn

#include "deltadyn/dynamics/regressor.hxx"
