#pragma once

/// \file
/// The ten inertial parameters of a rigid body and its pseudo-inertia (Gnad et al. 2024, (4), (12)).
///
/// All moments are taken about the origin of the body frame, not about the centre of mass.

#include <Eigen/Core>
#include <cmath>

#include "deltadyn/core/types.hpp"
#include "deltadyn/model/body.hpp"

namespace deltadyn {

/// Places of the entries in the 10-vector (4), whose names and units are in body.hpp.
namespace inertial {
inline constexpr int kM = 0;    ///< mass [kg]
inline constexpr int kMcx = 1;  ///< first moment [kg m]
inline constexpr int kMcy = 2;
inline constexpr int kMcz = 3;
inline constexpr int kIxx = 4;  ///< inertia tensor [kg m^2]
inline constexpr int kIyy = 5;
inline constexpr int kIzz = 6;
inline constexpr int kIxy = 7;  ///< entries of the tensor itself: Ixy = -integral of x y dm
inline constexpr int kIyz = 8;
inline constexpr int kIxz = 9;
}  // namespace inertial

template <class T>
using InertialVector = Vector<T, kInertialParameters>;
template <class T>
using PseudoInertia = Matrix<T, 4, 4>;

/// The 4 x 4 matrix (12): [S, m c; (m c)^T, m] with the second moments S = tr(Theta)/2 I - Theta. Linear in p.
template <class T>
[[nodiscard]] PseudoInertia<T> to_pseudo_inertia(const InertialVector<T>& p) {
  using namespace inertial;
  PseudoInertia<T> M;
  M(0, 0) = T(0.5) * (p(kIyy) + p(kIzz) - p(kIxx));
  M(1, 1) = T(0.5) * (p(kIxx) + p(kIzz) - p(kIyy));
  M(2, 2) = T(0.5) * (p(kIxx) + p(kIyy) - p(kIzz));
  M(0, 1) = M(1, 0) = -p(kIxy);
  M(1, 2) = M(2, 1) = -p(kIyz);
  M(0, 2) = M(2, 0) = -p(kIxz);
  for (int j = 0; j < 3; ++j) M(j, 3) = M(3, j) = p(kMcx + j);
  M(3, 3) = p(kM);
  return M;
}

/// Inverse of to_pseudo_inertia; reads the upper triangle of M.
template <class T>
[[nodiscard]] InertialVector<T> from_pseudo_inertia(const PseudoInertia<T>& M) {
  InertialVector<T> p;
  p << M(3, 3), M(0, 3), M(1, 3), M(2, 3), M(1, 1) + M(2, 2), M(0, 0) + M(2, 2), M(0, 0) + M(1, 1), -M(0, 1), -M(1, 2),
      -M(0, 2);
  return p;
}

/// The matrix G with <G, Mbar(p)> = g^T p for all p: a gradient in p seen in the space of pseudo-inertias.
template <class T>
[[nodiscard]] PseudoInertia<T> dual_pseudo_inertia(const InertialVector<T>& g) {
  using namespace inertial;
  PseudoInertia<T> G;
  G(0, 0) = g(kIyy) + g(kIzz);
  G(1, 1) = g(kIxx) + g(kIzz);
  G(2, 2) = g(kIxx) + g(kIyy);
  G(0, 1) = G(1, 0) = T(-0.5) * g(kIxy);
  G(1, 2) = G(2, 1) = T(-0.5) * g(kIyz);
  G(0, 2) = G(2, 0) = T(-0.5) * g(kIxz);
  for (int j = 0; j < 3; ++j) G(j, 3) = G(3, j) = T(0.5) * g(kMcx + j);
  G(3, 3) = g(kM);
  return G;
}

/// True if a body with positive density has these parameters: Mbar(p) is positive definite (V.A), which holds for the
/// mass, the triangle inequality of the inertias about the centre of mass, and the centre of mass itself.
/// \param tolerance smallest admitted pivot of Mbar scaled to a unit diagonal: free of units, 0 asks for strict
///                  definiteness.
template <class T>
[[nodiscard]] bool is_physically_consistent(const InertialVector<T>& p, T tolerance = T(0)) {
  using std::sqrt;
  const PseudoInertia<T> M = to_pseudo_inertia(p);
  for (int i = 0; i < 4; ++i) {
    if (!(M(i, i) > T(0))) return false;  // also refuses NaN
  }
  PseudoInertia<T> L = PseudoInertia<T>::Zero();
  for (int j = 0; j < 4; ++j) {
    T pivot = T(1);
    for (int k = 0; k < j; ++k) pivot -= L(j, k) * L(j, k);
    if (!(pivot > tolerance)) return false;
    L(j, j) = sqrt(pivot);
    for (int i = j + 1; i < 4; ++i) {
      // two roots, because the product of two small moments can underflow
      T entry = M(i, j) / sqrt(M(i, i)) / sqrt(M(j, j));
      for (int k = 0; k < j; ++k) entry -= L(i, k) * L(j, k);
      L(i, j) = entry / L(j, j);
    }
  }
  return true;
}

}  // namespace deltadyn
