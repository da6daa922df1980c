#pragma once

#include "deltadyn/effects/torque_offset.hpp"

namespace deltadyn {

/// Coulomb friction that differs by direction: (F+ - F-)/2, a constant beside the mean Coulomb friction. Amplitude [N m | N] of either
/// sign. The same column as `torque_offset` (its alias): a motion cannot tell an amplifier's offset from it.
template <class T>
T asymmetric_coulomb() {
  return torque_offset<T>();
}

}  // namespace deltadyn
