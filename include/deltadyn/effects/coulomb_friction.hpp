#pragma once

namespace deltadyn {

/// Coulomb friction: generalised force c sign(v), v the rate of the joint, parameter c [N m | N], c > 0; sign(0) = 0.
/// Says nothing about rest, where the force takes any value up to c: keep samples near a reversal out of a fit. Paper (7).
template <class T>
T coulomb_friction(const T& rate) {
  return rate > T(0) ? T(1) : (rate < T(0) ? T(-1) : T(0));
}

}  // namespace deltadyn
