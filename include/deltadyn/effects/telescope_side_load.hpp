#pragma once

#include <cmath>

#include "deltadyn/core/types.hpp"
#include "deltadyn/effects/coulomb_friction.hpp"

namespace deltadyn {

/// Friction of the telescope bar's guide under side load: mu |n| sign(l_d), borne by the drives through the Jacobian of the bar's length.
/// The side load per unit mass n is what the bar's plate-end needs across the bar: (a - g) without its part along the bar.
/// Amplitude: mu times the mass that the guide carries across [kg] > 0. Valid for a bar that is stiff beside its guide.
/// \param bar           unit vector along the bar
/// \param acceleration  of the plate [m/s^2]
/// \param gravity       [m/s^2]
template <class T>
T telescope_side_load(const T& bar_rate, const Vector3<T>& bar, const Vector3<T>& acceleration, const Vector3<T>& gravity) {
  using std::sqrt;
  const Vector3<T> needed = acceleration - gravity;
  const Vector3<T> across = needed - bar.dot(needed) * bar;
  return sqrt(across.squaredNorm()) * coulomb_friction(bar_rate);
}

}  // namespace deltadyn
