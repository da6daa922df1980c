#pragma once

#include <algorithm>
#include <cmath>

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// First-order lag of the recorded current or torque: T d(y)/dt + y = tau, amplitude and time constant T > 0 [s] (0.2
/// ms to 10 ms); y is recorded (recorded = 0). To second order the torque differs by -T d(tau)/dt + T^2 d2(tau)/dt2: a
/// lag in phase and a droop in size. A log of the commanded torque (recorded = 1) is the other way round: the motor's
/// torque lags, the record leads it by T d(tau)/dt. Valid for a current loop below its bandwidth. Source: Schroeder,
/// Elektrische Antriebe 2, 2015 (equivalent time constant).
struct CurrentLag : RecordedChange {
  static constexpr int kStage = 2;

  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "current_lag";
    t.effect_class = EffectClass::phase;
    t.place = EffectPlace::drive_or_robot;
    t.amplitudes = {{"time_constant", "s", Sign::positive, 1.0}};
    t.shapes = {ShapeTraits("time_constant", "s").from(2e-4, 0.015, 10),
                ShapeTraits("recorded", "", ShapeScale::choice).among({0, 1})};
    t.tied = true;
    t.form = {0.03, 0.06, 0.06};
    t.meaning = "the current loop lags like a first-order filter between the recorded torque and the motor's";
    t.shows = "phase and droop";
    t.remedy = "record the torque on the motor's side of the filter, or keep the term";
    return t;
  }

  template <class V>
  static V record(const V& torque, double dt, double time_constant, const Shape<double>& shape) {
    return shape[1] > 0.5 ? ahead(torque, dt, time_constant) : lagged(torque, dt, time_constant);
  }

 private:
  /// Exact for a torque that is linear between its samples.
  template <class V>
  static V lagged(const V& torque, double dt, double time_constant) {
    V out = torque;
    if (!(time_constant > 0)) return out;
    const double decay = std::exp(-dt / time_constant);
    for (Eigen::Index k = 1; k < torque.size(); ++k) {
      const double trail = time_constant * (torque(k) - torque(k - 1)) / dt;
      out(k) = torque(k) - trail + (out(k - 1) - torque(k - 1) + trail) * decay;
    }
    return out;
  }

  /// torque + T d(torque)/dt by central differences of seven points, of fewer near the ends.
  template <class V>
  static V ahead(const V& torque, double dt, double time_constant) {
    V out = torque;
    const Eigen::Index n = torque.size();
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Index reach = std::min(k, n - 1 - k);
      const auto step = [&](Eigen::Index m) { return torque(k + m) - torque(k - m); };
      double rate = 0;
      if (reach >= 3) {
        rate = (45 * step(1) - 9 * step(2) + step(3)) / 60;
      } else if (reach >= 1) {
        rate = step(1) / 2;
      } else if (n > 1) {
        rate = k == 0 ? torque(1) - torque(0) : torque(k) - torque(k - 1);
      }
      out(k) += time_constant * rate / dt;
    }
    return out;
  }
};

}  // namespace deltadyn::effects
