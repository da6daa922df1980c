#pragma once

/// \file
/// What one body's ten parameters (4) ask of its motion: force, moment and share of the mass matrix. Everything in the
/// body's frame and about its origin; the one place where inertias meet motions, for all of dynamics/.

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
    return inertia_times(body.w_d) + body.w.cross(inertia_times(body.w)) + mc.cross(body.a);
  }

  /// I v, written out: the quickest way in inverse dynamics.
  Vector3<T> inertia_times(const Vector3<T>& v) const {
    return Vector3<T>(I(0, 0) * v.x() + I(0, 1) * v.y() + I(0, 2) * v.z(),
                      I(0, 1) * v.x() + I(1, 1) * v.y() + I(1, 2) * v.z(),
                      I(0, 2) * v.x() + I(1, 2) * v.y() + I(2, 2) * v.z());
  }

  /// J^T I J, the body's share of M(q); N x N.
  template <int N>
  Matrix<T, N, N> mass_matrix(const BodyMotion<T, N>& body) const {
    const Matrix<T, 3, N> coupling = skew(mc).lazyProduct(body.J_w);  // mc x w
    const Matrix<T, 3, N> rotation = I.lazyProduct(body.J_w);
    return m * body.J_v.transpose().lazyProduct(body.J_v) - body.J_v.transpose().lazyProduct(coupling) -
           coupling.transpose().lazyProduct(body.J_v) + body.J_w.transpose().lazyProduct(rotation);
  }

  /// The body's share of C(q, qd); N x N. With A = Jd_v and B = Jd_w the rates of the Jacobians it is J_v^T (m A - mc x
  /// B - w x (mc x J_w)) + J_w^T (mc x A + I B + (P w) x J_w), P = tr(I)/2 - I the second moments of mass: the integral
  /// of (dr/dq)^T d/dt(dr/dq) over the mass. These are the Christoffel symbols of the body's kinetic energy, so that
  /// Mdot = C + C^T, Mdot - 2C is skew-symmetric, and d(C qd)/dqd = 2C.
  template <int N>
  Matrix<T, N, N> coriolis_matrix(const BodyState<T, N>& body) const {
    const Matrix3<T> S = skew(mc);
    const Vector3<T> P_w = T(0.5) * I.trace() * body.w - I.lazyProduct(body.w);
    const Matrix<T, 3, N> force =
        m * body.Jd_v - S.lazyProduct(body.Jd_w) - Matrix3<T>(skew(body.w).lazyProduct(S)).lazyProduct(body.J_w);
    const Matrix<T, 3, N> moment =
        S.lazyProduct(body.Jd_v) + I.lazyProduct(body.Jd_w) + skew(P_w).lazyProduct(body.J_w);
    return body.J_v.transpose().lazyProduct(force) + body.J_w.transpose().lazyProduct(moment);
  }

  /// The body's share of g(q), for gravity in the body's frame.
  template <int N>
  Vector<T, N> gravity_torque(const BodyMotion<T, N>& body, const Vector3<T>& gravity_B) const {
    return -(body.J_v.transpose().lazyProduct(m * gravity_B) + body.J_w.transpose().lazyProduct(mc.cross(gravity_B)));
  }
};

/// The inertia of a body in parameters p of a layout.
template <class Layout, class T>
BodyInertia<T> body_inertia(const Vector<T, Layout::kColumns>& p, Body kind, int index) {
  return BodyInertia<T>(p.template segment<kInertialParameters>(kInertialParameters * Layout::body(kind, index)));
}

}  // namespace deltadyn
