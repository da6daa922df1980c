#pragma once

/// \file
/// The generalised mass matrix M(q) of (1) in drive coordinates.

#include "deltadyn/dynamics/body_inertia.hpp"
#include "deltadyn/dynamics/regressor.hpp"

namespace deltadyn {

/// Adds the drives' rotor inertias to the sum over the bodies, and makes the sum, symmetric but for rounding, exactly
/// so.
template <class Layout, class T, int N>
void complete_mass_matrix(const Vector<T, Layout::kColumns>& p, Matrix<T, N, N>& M) {
  for (int i = 0; i < N; ++i) {
    M(i, i) += p(Layout::kRotorInertia + i);
    for (int j = 0; j < i; ++j) M(i, j) = M(j, i);
  }
}

/// M(q) = sum over the bodies of J^T I J plus the rotor inertias; N x N, exactly symmetric.
/// Positive definite for physically consistent parameters (paper V.A).
template <class Layout, class T, class Robot>
Matrix<T, Robot::kDrives, Robot::kDrives> mass_matrix(const Geometry<T, Robot>& geometry,
                                                      const Posture<T, Robot>& posture,
                                                      const Vector<T, Layout::kColumns>& p) {
  constexpr int N = Robot::kDrives;
  Motion<T, Robot> at_rest;
  at_rest.posture = posture;
  Matrix<T, N, N> M = Matrix<T, N, N>::Zero();
  for_each_body(geometry, at_rest, [&](Body kind, int index, int count, const BodyMotion<T, N>& body) {
    M += T(count) * body_inertia<Layout, T>(p, kind, index).mass_matrix(body);
  });
  complete_mass_matrix<Layout, T, N>(p, M);
  return M;
}

}  // namespace deltadyn
