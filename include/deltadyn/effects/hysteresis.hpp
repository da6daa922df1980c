#pragma once

#include <cmath>

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Hysteresis of flexsplines, cables and belts (Bouc 1967, Wen 1976): state z in [-1, 1],
///   dz/dt = (v - (|v| |z|^(n-1) z + v |z|^n) / 2) / D,   torque A z, A > 0 [N m | N].
/// So z falls or rises by the way over D until it is 0, and runs by dz = (1 - |z|^n) dx / D to its end from there.
/// Shape: displacement D > 0 [rad | m], over which the loop closes, 0.02 to 1 rad, wider than presliding; exponent n >=
/// 1, how sharp the knee is (n = 1 is Dahl's law). Valid for loops that do not depend on the rate. Source: Ismail,
/// Ikhouane, Rodellar, Arch. Comput. Methods Eng. 16, 2009.
struct Hysteresis : JointMemory {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "hysteresis";
    t.effect_class = EffectClass::reversal_memory;
    t.amplitudes = {{"torque", "{F}", Sign::positive}};
    t.shapes = {ShapeTraits("displacement", "{x}", ShapeScale::range).from(0.1, 0.6, 4).up_to(10),
                ShapeTraits("exponent", "").among({1, 2}).within(1, 10).searched({ShapeSearch::fixed})};
    t.memory = true;
    t.form = {0.03, 0.25, 0.06};
    t.meaning = "the drive's torque runs through a loop over its position (flexspline, belt, cable)";
    t.shows = "loop of the torque over the position";
    t.remedy = "use a hysteresis model; look at cables that run along the arm";
    return t;
  }

  template <class T>
  static T start(const T& sign, const Shape<T>&) {
    return sign;
  }

  template <class T>
  static T moved(const T& state, const T& step, const JointInput<T>&, const Shape<T>& shape) {
    using std::abs;
    const T up = step < T(0) ? T(-1) : T(1);  // mirrored, so that it always moves up
    T z = up * state, way = abs(step) / shape[0];
    if (z < T(0)) {
      if (way < -z) return up * (z + way);
      way += z;
      z = T(0);
    }
    return up * grown(z, way, shape[1]);
  }

  template <class T>
  static std::array<T, 1> columns(const T& state, const JointInput<T>&, const Shape<T>&) {
    return {state};
  }

 private:
  /// z after a way x of dz/dx = 1 - z^n, 0 <= z <= 1.
  template <class T>
  static T grown(T z, const T& x, const T& n) {
    using std::exp;
    using std::pow;
    using std::tanh;
    if (n == T(1)) return T(1) - (T(1) - z) * exp(-x);
    if (n == T(2)) {
      const T rise = tanh(x);
      return (z + rise) / (T(1) + z * rise);
    }
    // Runge-Kutta of order 4 in steps of at most a twentieth, to an error below 1e-7; what is 20 away has arrived.
    const T way = x < T(20) ? x : T(20);
    int parts = 1;
    while (T(parts) < T(20) * way) ++parts;
    const T h = way / T(parts);
    const auto slope = [&n](const T& at) { return at < T(1) ? T(1) - pow(at, n) : T(0); };
    for (int k = 0; k < parts; ++k) {
      const T k1 = slope(z), k2 = slope(z + h / T(2) * k1), k3 = slope(z + h / T(2) * k2), k4 = slope(z + h * k3);
      z += h / T(6) * (k1 + T(2) * k2 + T(2) * k3 + k4);
    }
    return z < T(1) ? z : T(1);
  }
};

}  // namespace deltadyn::effects
