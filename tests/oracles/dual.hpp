#pragma once

/// \file
/// Forward differentiation by dual numbers, to be nested for higher derivatives: Dual<Dual<Real>> carries a mixed
/// second one.

#include <Eigen/Core>
#include <cmath>
#include <type_traits>

namespace oracles {

using Real = long double;

/// value + slope e with e^2 = 0.
template <class S>
struct Dual {
  S value = S(0);
  S slope = S(0);

  Dual() = default;
  template <class A, class = std::enable_if_t<std::is_arithmetic_v<A>>>
  Dual(A a) : value(static_cast<S>(static_cast<Real>(a))) {}  // implicit, so that formulas read as for numbers
  Dual(const S& v, const S& s) : value(v), slope(s) {}

  friend Dual operator+(const Dual& a, const Dual& b) { return {a.value + b.value, a.slope + b.slope}; }
  friend Dual operator-(const Dual& a, const Dual& b) { return {a.value - b.value, a.slope - b.slope}; }
  friend Dual operator-(const Dual& a) { return {-a.value, -a.slope}; }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, a.value * b.slope + a.slope * b.value};
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const S ratio = a.value / b.value;
    return {ratio, (a.slope - ratio * b.slope) / b.value};
  }
  Dual& operator+=(const Dual& b) { return *this = *this + b; }
  Dual& operator-=(const Dual& b) { return *this = *this - b; }
  Dual& operator*=(const Dual& b) { return *this = *this * b; }
  Dual& operator/=(const Dual& b) { return *this = *this / b; }
  friend bool operator==(const Dual& a, const Dual& b) { return a.value == b.value && a.slope == b.slope; }
  friend bool operator!=(const Dual& a, const Dual& b) { return !(a == b); }

  friend Dual sqrt(const Dual& a) {
    using std::sqrt;
    const S root = sqrt(a.value);
    return {root, a.slope / (S(2) * root)};
  }
  friend Dual sin(const Dual& a) {
    using std::cos;
    using std::sin;
    return {sin(a.value), a.slope * cos(a.value)};
  }
  friend Dual cos(const Dual& a) {
    using std::cos;
    using std::sin;
    return {cos(a.value), -(a.slope * sin(a.value))};
  }
};

/// The number at the bottom of a nest.
inline Real base(const Real& x) {
  return x;
}
template <class S>
Real base(const Dual<S>& x) {
  return base(x.value);
}

}  // namespace oracles

namespace Eigen {

template <class S>
struct NumTraits<oracles::Dual<S>> : GenericNumTraits<oracles::Dual<S>> {
  using Real = oracles::Dual<S>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 2,
    AddCost = 2,
    MulCost = 4
  };
};

}  // namespace Eigen
