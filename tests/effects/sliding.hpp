#pragma once

/// \file
/// What the law of a joint sees of a joint that slides.

#include "deltadyn/core/sign.hpp"
#include "deltadyn/effects/kinds.hpp"

namespace deltadyn {

template <class T>
JointInput<T> sliding(T rate, T load = T(0)) {
  JointInput<T> in;
  in.rate = rate;
  in.sign = sign_of(rate);
  in.load = load;
  return in;
}

template <class T>
JointInput<T> at_position(T position, T sign = T(1)) {
  JointInput<T> in;
  in.position = position;
  in.sign = sign;
  return in;
}

}  // namespace deltadyn
