#pragma once

/// \file
/// The generalised mass matrix M(q) of (1) in drive coordinates.

#include "deltadyn/dynamics/regressor.hpp"

namespace deltadyn {

/// M(q) = sum over the bodies of J^T I J plus the rotor inertias; N x N, exactly symmetric.
/// Positive definite for physically consistent parameters (paper V.A).
template <class Layout, class T, class Robot>
Matrix<T, Robot::kDrives, Robot::kDrives> mass_matrix(const Geometry<T, Robot>& geometry, const Posture<T, Robot>& posture,
                                                      const Vector<T, Layout::kColumns>& p) {
  constexpr int N = Robot::kDrives;
  Motion<T, Robot> at_rest;
  at_rest.posture = posture;
  Matrix<T, N, N> M = Matrix<T, N, N>::Zero();
  for_each_body(geometry, at_rest, [&](Body kind, int index, int count, const BodyMotion<T, N>& body) {
    const auto b = p.template segment<kInertialParameters>(kInertialParameters * Layout::body(kind, index));
    Matrix3<T> I;
    I << b(4), b(7), b(9), b(7), b(5), b(8), b(9), b(8), b(6);
    const Matrix<T, 3, N> coupling = skew(Vector3<T>(b.template segment<3>(1))).lazyProduct(body.J_w);  // mc x w
    const Matrix<T, 3, N> rotation = I.lazyProduct(body.J_w);
    M += T(count) * (b(0) * body.J_v.transpose().lazyProduct(body.J_v) - body.J_v.transpose().lazyProduct(coupling) -
                     coupling.transpose().lazyProduct(body.J_v) + body.J_w.transpose().lazyProduct(rotation));
  });
  for (int drive = 0; drive < N; ++drive) M(drive, drive) += p(Layout::kRotorInertia + drive);
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < i; ++j) M(i, j) = M(j, i);
  }
  return M;
}

}  // namespace deltadyn
