#pragma once

/// \file
/// Elementary rotations. rot_z(a) turns a vector by +a about z (right hand rule): v_W = rot_z(a) v_B.

#include <cmath>

#include "deltadyn/core/types.hpp"

namespace deltadyn {

/// Sine and cosine of one angle, computed once and passed on.
template <class T>
struct SinCos {
  T sin = T(0);
  T cos = T(1);
  SinCos() = default;
  explicit SinCos(const T& angle) {
    using std::cos;
    using std::sin;
    this->sin = sin(angle);
    this->cos = cos(angle);
  }
  SinCos(const T& sine, const T& cosine) : sin(sine), cos(cosine) {}
};

/// rot_z(a) v without the matrix.
template <class T>
Vector3<T> turned_z(const SinCos<T>& a, const Vector3<T>& v) {
  return Vector3<T>(a.cos * v.x() - a.sin * v.y(), a.sin * v.x() + a.cos * v.y(), v.z());
}

template <class T>
Matrix3<T> rot_x(const SinCos<T>& a) {
  Matrix3<T> R;
  R << T(1), T(0), T(0), T(0), a.cos, -a.sin, T(0), a.sin, a.cos;
  return R;
}

template <class T>
Matrix3<T> rot_y(const SinCos<T>& a) {
  Matrix3<T> R;
  R << a.cos, T(0), a.sin, T(0), T(1), T(0), -a.sin, T(0), a.cos;
  return R;
}

template <class T>
Matrix3<T> rot_z(const SinCos<T>& a) {
  Matrix3<T> R;
  R << a.cos, -a.sin, T(0), a.sin, a.cos, T(0), T(0), T(0), T(1);
  return R;
}

/// S(v) with S(v) w = v x w.
template <class T>
Matrix3<T> skew(const Vector3<T>& v) {
  Matrix3<T> S;
  S << T(0), -v.z(), v.y(), v.z(), T(0), -v.x(), -v.y(), v.x(), T(0);
  return S;
}

/// e_z x v, for the many rotations about the vertical.
template <class T>
Vector3<T> cross_z(const Vector3<T>& v) {
  return Vector3<T>(-v.y(), v.x(), T(0));
}

}  // namespace deltadyn
