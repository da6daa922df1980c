#pragma once

#include "deltadyn/core/rotation.hpp"
#include "deltadyn/core/types.hpp"

namespace deltadyn {

/// The base is not level: gravity turned by the small angles delta_x, delta_y about the base's axes, g' = g + delta x g.
/// The torque changes by delta times the rigid model's torque with `tilted_gravity` minus the one with g, per radian of angle.
/// Amplitudes: the two angles [rad] of either sign, below 0.1. Valid for small angles (second order left out).
template <class T>
Vector3<T> tilted_gravity(const Vector3<T>& gravity, const T& angle_x, const T& angle_y) {
  const Vector3<T> delta(angle_x, angle_y, T(0));
  return gravity + skew(delta) * gravity;
}

}  // namespace deltadyn
