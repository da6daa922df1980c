#pragma once

#include <cmath>

namespace deltadyn {

/// Viscous friction that falls while the grease warms up: d (1 + b exp(-t/T)) v beside d v. Column: v exp(-t/T), amplitude d b
/// [N m s/rad | N s/m], > 0 for a cold start; T > 0 [s], seconds to minutes, t since the start of the log.
/// Valid for one thermal time constant. Source: Simoni et al., Robotica 33, 2015 (friction and temperature).
template <class T>
T thermal_drift(const T& rate, const T& time, const T& time_constant) {
  using std::exp;
  return rate * exp(-time / time_constant);
}

}  // namespace deltadyn
