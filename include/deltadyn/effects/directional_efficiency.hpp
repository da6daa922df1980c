#pragma once

#include <cmath>

#include "deltadyn/effects/coulomb_friction.hpp"

namespace deltadyn {

/// Loss of a gear whose efficiency differs between driving (the motor feeds power, tau_load v > 0) and back-driving.
struct EfficiencyColumn {
  enum Kind { driving, back_driving };
};

/// One of the two columns: |tau_load| sign(v) where the gear drives (back-drives), else 0. Amplitudes [1], both > 0: 1/eta_d - 1 when
/// driving, 1 - eta_b when back-driving; equal amplitudes are `load_dependent_friction`. tau_load as there.
/// Valid without play. Source: Wang, Yang, et al., worm and screw drives; Giberti, Cinquemani, Legnani 2010.
template <class T>
T directional_efficiency(const T& rate, const T& load, EfficiencyColumn::Kind column) {
  using std::abs;
  const bool drives = load * rate > T(0);
  return drives == (column == EfficiencyColumn::driving) ? T(abs(load) * coulomb_friction(rate)) : T(0);
}

}  // namespace deltadyn
