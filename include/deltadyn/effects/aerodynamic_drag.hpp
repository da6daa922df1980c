#pragma once

#include <cmath>

#include "deltadyn/core/types.hpp"

namespace deltadyn {

/// Drag of the plate and what it carries: the drives bear c J^T |v| v with the plate's velocity v [m/s] and its Jacobian J.
/// Amplitude c [N s^2/m^2] > 0: half the density of air times drag coefficient times area. Valid above Re of about 1000 and for
/// air at rest. \returns the force per unit c [m^2/s^2], in W.
template <class T>
Vector3<T> aerodynamic_drag(const Vector3<T>& velocity) {
  using std::sqrt;
  return sqrt(velocity.squaredNorm()) * velocity;
}

}  // namespace deltadyn
