#pragma once

/// \file
/// What one body's ten parameters (4) ask of its motion: force, moment and share of the mass matrix. Everything in the body's
/// frame and about its origin; the one place where inertias meet motions, for all of dynamics/.

#include "deltadyn/core/rotation.hpp"
#include "deltadyn/kinematics/body_motion.hpp"
#include "deltadyn/model/body.hpp"

namespace deltadyn {

/// Ten parameters, unpacked.
template <class T>
struct BodyInertia {
  T m;            ///< mass [kg]
  Vector3<T> mc;  ///< first moments [kg m]
  Matrix3<T> I;   ///< inertia tensor about the origin [kg m^2]

  template <class Ten>
  explicit BodyInertia(const Eigen::MatrixBase<Ten>& p) : m(p(0)), mc(p(1), p(2), p(3)) {
    I << p(4), p(7), p(9), p(7), p(5), p(8), p(9), p(8), p(6);
  }

  /// Force [N] that gives the body its motion; with BodyMotion::a, which leaves gravity out, net of its weight.
  template <int N>
  Vector3<T> force(const BodyMotion<T, N>& body) const {
    return m * body.a + body.w_d.cross(mc) + body.w.cross(body.w.cross(mc));
  }

  /// The moment [N m] about the origin that goes with force().
  template <int N>
  Vector3<T> moment(const BodyMotion<T, N>& body) const {
    return I.lazyProduct(body.w_d) + body.w.cross(I.lazyProduct(body.w)) + mc.cross(body.a);
  }

  /// J^T I J, the body's share of M(q); N x N.
  template <int N>
  Matrix<T, N, N> mass_matrix(const BodyMotion<T, N>& body) const {
    const Matrix<T, 3, N> coupling = skew(mc).lazyProduct(body.J_w);  // mc x w
    const Matrix<T, 3, N> rotation = I.lazyProduct(body.J_w);
    return m * body.J_v.transpose().lazyProduct(body.J_v) - body.J_v.transpose().lazyProduct(coupling) -
           coupling.transpose().lazyProduct(body.J_v) + body.J_w.transpose().lazyProduct(rotation);
  }
};

/// The inertia of a body in parameters p of a layout.
template <class Layout, class T>
BodyInertia<T> body_inertia(const Vector<T, Layout::kColumns>& p, Body kind, int index) {
  return BodyInertia<T>(p.template segment<kInertialParameters>(kInertialParameters * Layout::body(kind, index)));
}

}  // namespace deltadyn
