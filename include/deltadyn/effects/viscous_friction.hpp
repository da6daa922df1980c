#pragma once

namespace deltadyn {

/// Viscous friction: generalised force d v, v the rate of the joint [rad/s | m/s], parameter d [N m s/rad | N s/m], d > 0.
/// Valid for a full lubricant film and constant temperature. Paper (6).
template <class T>
T viscous_friction(const T& rate) {
  return rate;
}

}  // namespace deltadyn
