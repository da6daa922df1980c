#pragma once

/// \file
/// The motion of every body in its own frame, one after the other along the limbs. Everything in dynamics/ is built on
/// this one recursion: regressor, inverse dynamics and mass matrix on BodyMotion, Coriolis matrix, energies and
/// reactions on BodyState.

#include <Eigen/Geometry>

#include "deltadyn/kinematics/jacobian_rates.hpp"
#include "deltadyn/kinematics/motion.hpp"
#include "deltadyn/model/body.hpp"

namespace deltadyn {

/// Rates of one body, all in the body's frame B.
template <class T, int N>
struct BodyMotion {
  static constexpr bool kWithState = false;
  Vector3<T> a;         ///< acceleration of the origin minus gravity [m/s^2]
  Vector3<T> w;         ///< angular velocity [rad/s]
  Vector3<T> w_d;       ///< angular acceleration [rad/s^2]
  Matrix<T, 3, N> J_v;  ///< partial velocity of the origin by qd
  Matrix<T, 3, N> J_w;  ///< partial angular velocity by qd
};

/// The same, with the pose of the body and the rates of its Jacobians.
template <class T, int N>
struct BodyState : BodyMotion<T, N> {
  static constexpr bool kWithState = true;
  Matrix<T, 3, N> Jd_v;  ///< acceleration of the origin by qd: a + R_WB^T gravity = J_v qdd + Jd_v qd
  Matrix<T, 3, N> Jd_w;  ///< angular acceleration by qd: w_d = J_w qdd + Jd_w qd
  Matrix3<T> R_WB;       ///< orientation
  Vector3<T> p_WB;       ///< place of the origin from W [m]; of two struts that move alike, of the point between them
};

/// Calls visit(Body kind, int index, int count, const BodyMotion&) for every body: `index` is the limb or the part of
/// the plate, `count` the number of bodies that move alike (the two struts of a limb: same orientation, elbows and
/// attachments offset by a constant vector along the arm's axis, hence the same rates).
template <class T, class Robot, class Visitor>
void for_each_body(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion, Visitor&& visit);

/// The same with BodyState; `rates` are jacobian_rates() of the motion, or zeros where nobody looks at Jd_v and Jd_w.
template <class T, class Robot, class Visitor>
void for_each_body(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion,
                   const JacobianRates<T, Robot>& rates, Visitor&& visit);

}  // namespace deltadyn

#include "deltadyn/kinematics/body_motion.hxx"
