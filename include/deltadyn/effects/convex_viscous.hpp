#pragma once

#include <cmath>

#include "deltadyn/effects/coulomb_friction.hpp"

namespace deltadyn {

/// Viscous friction that grows faster than the rate: Fq |v/v1|^a sign(v), a > 1 (1.5 to 3), v1 the reference rate [rad/s | m/s],
/// amplitude Fq [N m | N] at v1, Fq > 0. Churning losses of oil and turbulent films; on the plate see `aerodynamic_drag`.
/// Source: Niemann, Winter, Maschinenelemente 2, 2003, load-independent losses.
template <class T>
T convex_viscous(const T& rate, const T& exponent, const T& reference_rate = T(1)) {
  using std::abs;
  using std::pow;
  const T x = abs(rate) / reference_rate;
  return x > T(0) ? T(pow(x, exponent) * coulomb_friction(rate)) : T(0);
}

}  // namespace deltadyn
