#pragma once

/// \file
/// Forward differentiation: a number with its partial derivatives in N directions, exact to rounding, fixed size.

#include <Eigen/Core>
#include <cmath>
#include <type_traits>

#include "deltadyn/core/types.hpp"

namespace deltadyn {

/// value + slope . epsilon with epsilon^2 = 0. Comparisons look at the value only.
template <class T, int N>
struct Dual {
  T value = T(0);
  Vector<T, N> slope = Vector<T, N>::Zero();

  Dual() = default;
  template <class A, class = std::enable_if_t<std::is_arithmetic_v<A>>>
  Dual(A a) : value(static_cast<T>(a)) {}  // implicit, so that formulas read as for numbers
  Dual(const T& v, const Vector<T, N>& s) : value(v), slope(s) {}

  Dual& operator+=(const Dual& b) {
    value += b.value;
    slope += b.slope;
    return *this;
  }
  Dual& operator-=(const Dual& b) {
    value -= b.value;
    slope -= b.slope;
    return *this;
  }
  Dual& operator*=(const Dual& b) { return *this = *this * b; }
  Dual& operator/=(const Dual& b) { return *this = *this / b; }

  friend Dual operator+(Dual a, const Dual& b) { return a += b; }
  friend Dual operator-(Dual a, const Dual& b) { return a -= b; }
  friend Dual operator-(const Dual& a) { return Dual(-a.value, -a.slope); }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return Dual(a.value * b.value, a.value * b.slope + b.value * a.slope);
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const T ratio = a.value / b.value;
    return Dual(ratio, (a.slope - ratio * b.slope) / b.value);
  }

  friend bool operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  friend bool operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
  friend bool operator<=(const Dual& a, const Dual& b) { return a.value <= b.value; }
  friend bool operator>=(const Dual& a, const Dual& b) { return a.value >= b.value; }
  friend bool operator==(const Dual& a, const Dual& b) { return !(a.value < b.value) && !(a.value > b.value); }
  friend bool operator!=(const Dual& a, const Dual& b) { return !(a == b); }

  friend Dual abs(const Dual& a) { return a.value < T(0) ? -a : a; }
  friend Dual sqrt(const Dual& a) {
    using std::sqrt;
    const T root = sqrt(a.value);
    return Dual(root, a.slope / (T(2) * root));
  }
  friend Dual sin(const Dual& a) {
    using std::cos;
    using std::sin;
    return Dual(sin(a.value), cos(a.value) * a.slope);
  }
  friend Dual cos(const Dual& a) {
    using std::cos;
    using std::sin;
    return Dual(cos(a.value), -sin(a.value) * a.slope);
  }
  friend Dual exp(const Dual& a) {
    using std::exp;
    const T power = exp(a.value);
    return Dual(power, power * a.slope);
  }
  friend Dual tanh(const Dual& a) {
    using std::tanh;
    const T tangent = tanh(a.value);
    return Dual(tangent, (T(1) - tangent * tangent) * a.slope);
  }
  /// a^b for a > 0.
  friend Dual pow(const Dual& a, const Dual& b) {
    using std::log;
    using std::pow;
    const T power = pow(a.value, b.value);
    return Dual(power, power * (b.value / a.value * a.slope + log(a.value) * b.slope));
  }
};

}  // namespace deltadyn

namespace Eigen {

template <class T, int N>
struct NumTraits<deltadyn::Dual<T, N>> : GenericNumTraits<deltadyn::Dual<T, N>> {
  using Real = deltadyn::Dual<T, N>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = N + 1,
    AddCost = N + 1,
    MulCost = 3 * N + 1
  };
};

}  // namespace Eigen
