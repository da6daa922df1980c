#pragma once

namespace deltadyn {

/// Sign of a rate, 0 at rest: Coulomb friction per unit (7). Says nothing about rest, where friction takes any value up
/// to its size.
template <class T>
T sign_of(const T& rate) {
  return rate > T(0) ? T(1) : (rate < T(0) ? T(-1) : T(0));
}

}  // namespace deltadyn
