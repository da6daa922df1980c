#pragma once

#include "deltadyn/effects/stribeck.hpp"

namespace deltadyn {

/// Stribeck effect of the telescope bar's prismatic joint: `stribeck` of the bar's rate, borne by the drives through the Jacobian of
/// its length. Amplitude dF [N] > 0, shape rate [m/s].
template <class T>
T telescope_stribeck(const T& bar_rate, const StribeckShape<T>& shape) {
  return stribeck(bar_rate, shape);
}

}  // namespace deltadyn
