#pragma once

#include <cmath>

namespace deltadyn {

/// Ripple of motor and gear over position: A cos(n q + phi) = a cos(n q) + b sin(n q). Amplitudes a, b [N m | N] of either sign.
/// n > 0 is free [1/rad | 1/m]: cogging has n = gear ratio x slots, tooth meshing n = teeth. Valid while n |v| stays in the pass band.
/// Source: Gandhi, Thorby, torque ripple of permanent-magnet drives; Holtz, Springob 1996.
template <class T>
struct RipplePair {
  T cosine, sine;
};

template <class T>
RipplePair<T> torque_ripple(const T& position, const T& n) {
  using std::cos;
  using std::sin;
  const T angle = n * position;
  return {T(cos(angle)), T(sin(angle))};
}

}  // namespace deltadyn
