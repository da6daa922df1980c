#pragma once

#include "deltadyn/effects/coulomb_friction.hpp"
#include "deltadyn/effects/torque_ripple.hpp"

namespace deltadyn {

/// Coulomb friction that varies over a turn: Fc A cos(n q + phi) sign(v) beside Fc sign(v), by eccentric wheels and uneven preload.
/// Amplitudes of the cosine and the sine [N m | N] of either sign, together below Fc; n > 0 [1/rad | 1/m], mostly a small integer.
/// Flips with the direction, which `torque_ripple` does not. Source: Armstrong-Helouvry, Control of Machines with Friction, 1991.
template <class T>
RipplePair<T> position_dependent_friction(const T& position, const T& rate, const T& n) {
  const RipplePair<T> wave = torque_ripple(position, n);
  const T sign = coulomb_friction(rate);
  return {T(wave.cosine * sign), T(wave.sine * sign)};
}

}  // namespace deltadyn
