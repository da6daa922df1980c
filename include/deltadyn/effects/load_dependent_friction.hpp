#pragma once

#include <cmath>

#include "deltadyn/effects/coulomb_friction.hpp"

namespace deltadyn {

/// Friction in proportion to the transmitted load: mu |tau_load| sign(v), amplitude mu [1], mu > 0; tau_load is what the gear passes on,
/// the rigid model's torque without the drive's own friction [N m | N]. Valid for gears and bearings under load while they slide.
/// Source: Hamon, Gautier, Garrec, IROS 2010.
template <class T>
T load_dependent_friction(const T& rate, const T& load) {
  using std::abs;
  return abs(load) * coulomb_friction(rate);
}

}  // namespace deltadyn
