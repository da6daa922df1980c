#pragma once

#include <cmath>

namespace deltadyn {

/// Torque that the motor does not reach at its peaks: what lies above `level` comes out reduced by the share A, 0 < A <= 1
/// (1: cut off, below 1: magnetic saturation softens it). A < 0 where the log holds the command, which then exceeds the motor's torque.
/// Column: -(|tau| - level) sign(tau) where |tau| > level [N m | N].
/// level > 0 [N m | N], 50 % to 95 % of the largest torque. Tells itself from a gain error by leaving the small torques alone.
template <class T>
T saturation(const T& torque, const T& level) {
  using std::abs;
  const T beyond = abs(torque) - level;
  if (!(beyond > T(0))) return T(0);
  return torque > T(0) ? T(-beyond) : beyond;
}

}  // namespace deltadyn
