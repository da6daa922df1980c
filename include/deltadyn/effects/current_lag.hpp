#pragma once

#include <cmath>

namespace deltadyn {

/// First-order lag of the recorded current or torque: T d(y)/dt + y = tau, time constant T > 0 [s] (0.2 ms to 10 ms); y is recorded.
/// To second order the torque differs by -T d(tau)/dt + T^2 d2(tau)/dt2: a lag in phase and a droop in size.
/// A log of the commanded torque is the other way round: the motor's torque lags, the record leads it by +T d(tau)/dt.
/// Valid for a current loop below its bandwidth. Source: Schroeder, Elektrische Antriebe 2, 2015 (equivalent time constant).
template <class T>
T current_lag(const T& torque_rate, const T& torque_dd, const T& time_constant) {
  return -torque_rate + time_constant * torque_dd;
}

/// What the record of the command in front of the lag adds to the motor's torque, per T.
template <class T>
T current_lead(const T& torque_rate) {
  return torque_rate;
}

/// The lag itself over samples, exact for a torque that is constant between them.
template <class T>
class CurrentLag {
 public:
  CurrentLag(const T& time_constant, const T& start) : time_constant_(time_constant), state_(start) {}
  /// Output after dt [s] under the torque tau.
  const T& step(const T& tau, const T& dt) {
    using std::exp;
    state_ = tau + (state_ - tau) * exp(-dt / time_constant_);
    return state_;
  }

 private:
  T time_constant_, state_;
};

}  // namespace deltadyn
