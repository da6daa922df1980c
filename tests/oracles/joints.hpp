#pragma once

/// \file
/// Free rigid bodies and the equations that joints put between them: maximal coordinates, in which no mechanism is
/// anything but a list of bodies and of joints.
///
/// An equation is a sum of readings, and a reading is what a ruler or a protractor between two bodies shows. Readings
/// take dual numbers, so every derivative comes from moving a body, never from a formula for it.

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <vector>

#include "oracles/dual.hpp"

namespace oracles {

// The one place where an angle is read off a body.
template <class S>
S arc(const S& y, const S& x) {
  if constexpr (std::is_floating_point_v<S>) {
    return std::atan2(y, x);
  } else {
    return {arc(y.value, x.value), (x.value * y.slope - y.value * x.slope) / (x.value * x.value + y.value * y.value)};
  }
}

namespace bodies {

using Real3 = Eigen::Matrix<Real, 3, 1>;
using Real33 = Eigen::Matrix<Real, 3, 3>;

/// Where a body is: orientation and origin of its frame in the base frame. Body 0 of a list is the base.
template <class S>
struct Place {
  Eigen::Matrix<S, 3, 3> R;
  Eigen::Matrix<S, 3, 1> p;
};
using Places = std::vector<Place<Real>>;

/// Angular velocity and velocity of the origin, or their rates, in the base frame.
using Twist = Eigen::Matrix<Real, 6, 1>;

inline Real33 cross_matrix(const Real3& v) {
  Real33 S;
  S << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return S;
}

/// A body's place with its slope by a twist.
inline Place<Dual<Real>> moved(const Place<Real>& at, const Twist& twist) {
  const Real33 slope = cross_matrix(twist.head<3>()) * at.R;
  Place<Dual<Real>> out;
  for (int i = 0; i < 3; ++i) {
    out.p(i) = {at.p(i), twist(3 + i)};
    for (int j = 0; j < 3; ++j) out.R(i, j) = {at.R(i, j), slope(i, j)};
  }
  return out;
}

/// A body's place along time in second order, at a twist and its rate.
inline Place<Dual<Dual<Real>>> in_flight(const Place<Real>& at, const Twist& twist, const Twist& rate) {
  const Real33 W = cross_matrix(twist.head<3>());
  const Real33 first = W * at.R;
  const Real33 second = (cross_matrix(rate.head<3>()) + W * W) * at.R;
  Place<Dual<Dual<Real>>> out;
  for (int i = 0; i < 3; ++i) {
    out.p(i) = {{at.p(i), twist(3 + i)}, {twist(3 + i), rate(3 + i)}};
    for (int j = 0; j < 3; ++j) out.R(i, j) = {{at.R(i, j), first(i, j)}, {first(i, j), second(i, j)}};
  }
  return out;
}

/// What a ruler or a protractor between bodies a and b shows. Vectors stand in the frame of the body that they name.
struct Reading {
  enum class Kind {
    travel,  ///< of point second_b from point second_a, along first_a
    cosine,  ///< between the directions first_a and first_b
    angle    ///< of the direction first_b in the plane of a that has the axes first_a and second_a
  };
  Kind kind;
  std::size_t a, b;
  Real3 first_a, second_a, first_b, second_b;
};

inline Reading travel(std::size_t a, const Real3& along, const Real3& from, std::size_t b, const Real3& to) {
  return {Reading::Kind::travel, a, b, along, from, Real3::Zero(), to};
}
inline Reading cosine(std::size_t a, const Real3& of, std::size_t b, const Real3& and_of) {
  return {Reading::Kind::cosine, a, b, of, Real3::Zero(), and_of, Real3::Zero()};
}
inline Reading angle(std::size_t a, const Real3& from, const Real3& towards, std::size_t b, const Real3& of) {
  return {Reading::Kind::angle, a, b, from, towards, of, Real3::Zero()};
}

template <class S>
Eigen::Matrix<S, 3, 1> turned(const Place<S>& at, const Real3& v) {
  Eigen::Matrix<S, 3, 1> out;
  for (int i = 0; i < 3; ++i) out(i) = at.R(i, 0) * S(v.x()) + at.R(i, 1) * S(v.y()) + at.R(i, 2) * S(v.z());
  return out;
}

template <class S>
S dot(const Eigen::Matrix<S, 3, 1>& v, const Eigen::Matrix<S, 3, 1>& w) {
  return v.x() * w.x() + v.y() * w.y() + v.z() * w.z();
}

template <class S>
S value(const Reading& reading, const Place<S>& a, const Place<S>& b) {
  const Eigen::Matrix<S, 3, 1> e = turned(a, reading.first_a);
  if (reading.kind == Reading::Kind::cosine) return dot<S>(e, turned(b, reading.first_b));
  const Eigen::Matrix<S, 3, 1> f = turned(a, reading.second_a);
  if (reading.kind == Reading::Kind::angle) {
    const Eigen::Matrix<S, 3, 1> of = turned(b, reading.first_b);
    return arc(dot<S>(of, f), dot<S>(of, e));
  }
  Eigen::Matrix<S, 3, 1> from_to = turned(b, reading.second_b);
  for (int i = 0; i < 3; ++i) from_to(i) += b.p(i) - a.p(i) - f(i);
  return dot<S>(e, from_to);
}

/// Derivatives of a reading by the twists of its two bodies.
struct Slopes {
  Twist by_a, by_b;
};
inline Slopes slopes(const Reading& reading, const Places& at) {
  const Place<Dual<Real>> a = moved(at[reading.a], Twist::Zero()), b = moved(at[reading.b], Twist::Zero());
  Slopes out;
  for (int k = 0; k < 6; ++k) {
    out.by_a(k) = reading.a == 0 ? 0 : value(reading, moved(at[reading.a], Twist::Unit(k)), b).slope;
    out.by_b(k) = reading.b == 0 ? 0 : value(reading, a, moved(at[reading.b], Twist::Unit(k))).slope;
  }
  return out;
}

/// Sum of readings, each times a number, that is the coordinate of a drive, or zero where there is none.
struct Equation {
  struct Term {
    Real times;
    Reading reading;
  };
  std::vector<Term> terms;
  int drive = -1;
};
using Equations = std::vector<Equation>;

// The joints. Each adds the equations that a fitter would: where points meet, which axes stay square to each other.

inline void ball(Equations& to, std::size_t a, const Real3& in_a, std::size_t b, const Real3& in_b) {
  for (int k = 0; k < 3; ++k) to.push_back({{{1, travel(a, Real3::Unit(k), in_a, b, in_b)}}});
}
inline void square(Equations& to, std::size_t a, const Real3& of, std::size_t b, const Real3& and_of) {
  to.push_back({{{1, cosine(a, of, b, and_of)}}});
}
/// Bodies whose z axes stay parallel.
inline void upright(Equations& to, std::size_t a, std::size_t b) {
  square(to, a, Real3::UnitX(), b, Real3::UnitZ());
  square(to, a, Real3::UnitY(), b, Real3::UnitZ());
}
/// Hinge about z of both bodies.
inline void hinge(Equations& to, std::size_t a, const Real3& in_a, std::size_t b, const Real3& in_b) {
  ball(to, a, in_a, b, in_b);
  upright(to, a, b);
}

}  // namespace bodies
}  // namespace oracles
