#pragma once

#include <cmath>

namespace deltadyn {

/// A wave over position, A cos(n q + phi) = a cos(n q) + b sin(n q): the two parts, per unit of a and b.
template <class T>
struct Wave {
  T cosine, sine;
};

/// \param n  waves per 2 pi of position, n > 0 [1/rad | 1/m]
template <class T>
Wave<T> wave(const T& position, const T& n) {
  using std::cos;
  using std::sin;
  const T angle = n * position;
  return {T(cos(angle)), T(sin(angle))};
}

}  // namespace deltadyn
