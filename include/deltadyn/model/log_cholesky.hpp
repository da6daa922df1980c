#pragma once

/// \file
/// Log-Cholesky variables of a rigid body (Gnad et al. 2024, V.A, (13), (14); Rucker and Wensing 2022).
///
/// Mbar(p) = U^T U with the upper triangular
///
///     U = e^alpha [ e^d1  s12   s13   t1 ]
///                 [ 0     e^d2  s23   t2 ]
///                 [ 0     0     e^d3  t3 ]
///                 [ 0     0     0     1  ]
///
/// Every pi gives a physically consistent p, and every consistent p has exactly one pi.
///
/// Multiplied out, U^T U differs from (14) as printed in two places: the paper's list has nine entries because Izz =
/// e^{2 alpha} (s12^2 + e^{2 d1} + e^{2 d2}) is missing, and its Iyy has s12^2 + s13^2 where the product has s13^2 +
/// s23^2. With s = 0 both agree with the paper's own (16). Here the product is used; tests/model/log_cholesky_test.cpp
/// shows it.

#include <Eigen/Core>
#include <cmath>

#include "deltadyn/core/status.hpp"
#include "deltadyn/core/types.hpp"
#include "deltadyn/model/inertial_parameters.hpp"

namespace deltadyn {

/// Log-Cholesky variables in the order of (13).
namespace log_cholesky {
inline constexpr int kAlpha = 0;
inline constexpr int kD1 = 1;
inline constexpr int kD2 = 2;
inline constexpr int kD3 = 3;
inline constexpr int kS12 = 4;
inline constexpr int kS23 = 5;
inline constexpr int kS13 = 6;
inline constexpr int kT1 = 7;
inline constexpr int kT2 = 8;
inline constexpr int kT3 = 9;
inline constexpr int kCount = 10;
inline constexpr const char* kNames[kCount] = {"alpha", "d1", "d2", "d3", "s12", "s23", "s13", "t1", "t2", "t3"};
}  // namespace log_cholesky

template <class T>
using LogCholeskyVector = Vector<T, log_cholesky::kCount>;

/// p(pi), (14) as corrected above. Finite for every finite pi within the range of exp.
template <class T>
[[nodiscard]] InertialVector<T> from_log_cholesky(const LogCholeskyVector<T>& pi) {
  using std::exp;
  using namespace log_cholesky;
  const T e1 = exp(pi(kD1)), e2 = exp(pi(kD2)), e3 = exp(pi(kD3));
  const T s12 = pi(kS12), s23 = pi(kS23), s13 = pi(kS13), t1 = pi(kT1), t2 = pi(kT2), t3 = pi(kT3);
  const T S11 = e1 * e1;
  const T S22 = s12 * s12 + e2 * e2;
  const T S33 = s13 * s13 + s23 * s23 + e3 * e3;
  InertialVector<T> p;
  p << t1 * t1 + t2 * t2 + t3 * t3 + T(1), t1 * e1, t1 * s12 + t2 * e2, t1 * s13 + t2 * s23 + t3 * e3, S22 + S33,
      S11 + S33, S11 + S22, -s12 * e1, -s12 * s13 - s23 * e2, -s13 * e1;
  return p * exp(T(2) * pi(kAlpha));
}

/// The analytic Jacobian dp/dpi, 10 x 10, rows in the order of (4), columns in the order of (13). Regular for every pi.
template <class T>
[[nodiscard]] Matrix<T, 10, 10> log_cholesky_jacobian(const LogCholeskyVector<T>& pi) {
  using std::exp;
  using namespace log_cholesky;
  using namespace inertial;
  const T e1 = exp(pi(kD1)), e2 = exp(pi(kD2)), e3 = exp(pi(kD3));
  const T s12 = pi(kS12), s23 = pi(kS23), s13 = pi(kS13), t1 = pi(kT1), t2 = pi(kT2), t3 = pi(kT3);
  Matrix<T, 10, 10> J = Matrix<T, 10, 10>::Zero();

  J(kMcx, kD1) = t1 * e1;
  J(kIyy, kD1) = J(kIzz, kD1) = T(2) * e1 * e1;
  J(kIxy, kD1) = -s12 * e1;
  J(kIxz, kD1) = -s13 * e1;

  J(kMcy, kD2) = t2 * e2;
  J(kIxx, kD2) = J(kIzz, kD2) = T(2) * e2 * e2;
  J(kIyz, kD2) = -s23 * e2;

  J(kMcz, kD3) = t3 * e3;
  J(kIxx, kD3) = J(kIyy, kD3) = T(2) * e3 * e3;

  J(kMcy, kS12) = t1;
  J(kIxx, kS12) = J(kIzz, kS12) = T(2) * s12;
  J(kIxy, kS12) = -e1;
  J(kIyz, kS12) = -s13;

  J(kMcz, kS23) = t2;
  J(kIxx, kS23) = J(kIyy, kS23) = T(2) * s23;
  J(kIyz, kS23) = -e2;

  J(kMcz, kS13) = t1;
  J(kIxx, kS13) = J(kIyy, kS13) = T(2) * s13;
  J(kIyz, kS13) = -s12;
  J(kIxz, kS13) = -e1;

  J(kM, kT1) = T(2) * t1;
  J(kMcx, kT1) = e1;
  J(kMcy, kT1) = s12;
  J(kMcz, kT1) = s13;

  J(kM, kT2) = T(2) * t2;
  J(kMcy, kT2) = e2;
  J(kMcz, kT2) = s23;

  J(kM, kT3) = T(2) * t3;
  J(kMcz, kT3) = e3;

  J *= exp(T(2) * pi(kAlpha));
  J.col(kAlpha) = T(2) * from_log_cholesky(pi);
  return J;
}

/// pi(p): the Cholesky factor of Mbar(p), read off.
/// \return Status::out_of_range and pi unchanged if p is not physically consistent
template <class T>
Status to_log_cholesky(const InertialVector<T>& p, LogCholeskyVector<T>& pi) {
  using std::isfinite;
  using std::log;
  using std::sqrt;
  using namespace log_cholesky;
  const PseudoInertia<T> M = to_pseudo_inertia(p);
  PseudoInertia<T> U = PseudoInertia<T>::Zero();
  for (int i = 0; i < 4; ++i) {
    T pivot = M(i, i);
    for (int k = 0; k < i; ++k) pivot -= U(k, i) * U(k, i);
    if (!(pivot > T(0)) || !isfinite(pivot)) return Status::out_of_range;
    U(i, i) = sqrt(pivot);
    for (int j = i + 1; j < 4; ++j) {
      T entry = M(i, j);
      for (int k = 0; k < i; ++k) entry -= U(k, i) * U(k, j);
      U(i, j) = entry / U(i, i);
    }
  }
  const T scale = U(3, 3);
  pi(kAlpha) = log(scale);
  for (int j = 0; j < 3; ++j) {
    pi(kD1 + j) = log(U(j, j) / scale);
    pi(kT1 + j) = U(j, 3) / scale;
  }
  pi(kS12) = U(0, 1) / scale;
  pi(kS23) = U(1, 2) / scale;
  pi(kS13) = U(0, 2) / scale;
  return Status::ok;
}

}  // namespace deltadyn
