#pragma once

#include <cmath>

#include "deltadyn/core/types.hpp"

namespace deltadyn {

/// What the telescope bar's plate-end needs across the bar, per unit mass [m/s^2]: (a - g) without its part along the
/// bar.
/// \param bar           unit vector along the bar
/// \param acceleration  of the plate [m/s^2]
/// \param gravity       [m/s^2]
template <class T>
T side_load(const Vector3<T>& bar, const Vector3<T>& acceleration, const Vector3<T>& gravity) {
  using std::sqrt;
  const Vector3<T> needed = acceleration - gravity;
  return sqrt((needed - bar.dot(needed) * bar).squaredNorm());
}

}  // namespace deltadyn
