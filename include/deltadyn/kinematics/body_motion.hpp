#pragma once

/// \file
/// The motion of every body in its own frame, one after the other along the limbs. Regressor, inverse dynamics and mass matrix
/// are all built on this one recursion.

#include <Eigen/Geometry>

#include "deltadyn/kinematics/motion.hpp"
#include "deltadyn/model/body.hpp"

namespace deltadyn {

/// Rates of one body, all in the body's frame B.
template <class T, int N>
struct BodyMotion {
  Vector3<T> a;         ///< acceleration of the origin minus gravity [m/s^2]
  Vector3<T> w;         ///< angular velocity [rad/s]
  Vector3<T> w_d;       ///< angular acceleration [rad/s^2]
  Matrix<T, 3, N> J_v;  ///< partial velocity of the origin by qd
  Matrix<T, 3, N> J_w;  ///< partial angular velocity by qd
};

/// Calls visit(Body kind, int index, int count, const BodyMotion&) for every body: `index` is the limb or the part of the plate,
/// `count` the number of bodies that move alike (the two struts of a limb: same orientation, elbows and attachments offset by a
/// constant vector along the arm's axis, hence the same rates).
template <class T, class Robot, class Visitor>
void for_each_body(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion, Visitor&& visit);

}  // namespace deltadyn

#include "deltadyn/kinematics/body_motion.hxx"
