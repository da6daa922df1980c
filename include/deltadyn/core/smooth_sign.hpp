#pragma once

#include <cmath>

#include "deltadyn/core/sign.hpp"

namespace deltadyn {

/// Sign of a rate that does not jump at rest: rate / sqrt(rate^2 + width^2), which is 0 at rest and 0.7 at the width.
/// \param width  in the unit of the rate; 0: as sign_of
template <class T>
T smooth_sign(const T& rate, const T& width) {
  using std::sqrt;
  if (!(width > T(0))) return sign_of(rate);
  const T size = rate < T(0) ? T(-rate) : rate;
  // The larger of the two is divided out, so that no square overflows.
  if (size < width) {
    const T share = rate / width;
    return share / sqrt(T(1) + share * share);
  }
  const T share = width / size;
  return sign_of(rate) / sqrt(T(1) + share * share);
}

}  // namespace deltadyn
