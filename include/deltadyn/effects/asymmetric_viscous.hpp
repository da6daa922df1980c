#pragma once

#include <cmath>

namespace deltadyn {

/// Viscous friction that differs by direction: b |v| beside the mean d v, so that d + b holds for v > 0 and d - b for v < 0.
/// Amplitude b [N m s/rad | N s/m] of either sign, |b| < d. Source: Janot, Gautier, Brunot 2019 (EMPS, a screw axis).
template <class T>
T asymmetric_viscous(const T& rate) {
  using std::abs;
  return abs(rate);
}

}  // namespace deltadyn
