#pragma once

#include "deltadyn/core/types.hpp"

namespace deltadyn {

/// A mass dm on the plate that only some logs have: force dm (a - g) on the plate, torque J^T of it per unit mass; amplitude dm [kg] > 0
/// in the logs with it. Two logs can only tell it from the plate's own mass if one of them is without.
/// \param acceleration  of the plate in W [m/s^2]
/// \param gravity       in W [m/s^2]
template <class T>
Vector3<T> payload_force(const Vector3<T>& acceleration, const Vector3<T>& gravity) {
  return acceleration - gravity;
}

}  // namespace deltadyn
