#pragma once

namespace deltadyn {

/// Torque stamped late by delta beside the positions: tau(t - delta) in place of tau(t), to first order -delta d(tau)/dt.
/// Amplitude delta [s] of either sign, a few sample times. Dead time keeps the size of every frequency, which `current_lag` does not.
/// \param torque_rate  time derivative of the model's torque [N m/s | N/s]
template <class T>
T time_skew(const T& torque_rate) {
  return -torque_rate;
}

}  // namespace deltadyn
