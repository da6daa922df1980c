#pragma once

#include <algorithm>

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Torque stamped late by delta beside the positions: tau(t - delta) in place of tau(t), amplitude delta [s] of either
/// sign, a few sample times. Dead time keeps the size of every frequency, which `current_lag` does not.
struct TimeSkew : RecordedChange {
  static constexpr int kStage = 3;

  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "time_skew";
    t.effect_class = EffectClass::phase;
    t.place = EffectPlace::drive_or_robot;
    t.amplitudes = {{"delay", "s", Sign::either, 1.0}};
    t.shapes = {ShapeTraits("delay", "s").from_both_signs(2e-4, 0.012, 9)};
    t.tied = true;
    t.form = {0.03, 0.06, 0.06};
    t.meaning = "torque and position are not sampled at the same time";
    t.shows = "phase";
    t.remedy = "shift the torque by the delay, or mend the time stamps";
    return t;
  }

  template <class V>
  static V record(const V& torque, double dt, double delay, const Shape<double>&) {
    return shifted(torque, delay / dt, true);
  }
  /// Along straight lines between the samples, by which the sets of lag and skew were tuned.
  template <class V>
  static V expected(const V& torque, double dt, double delay, const Shape<double>&) {
    return shifted(torque, delay / dt, false);
  }

 private:
  template <class V>
  static V shifted(const V& torque, double samples, bool cubic) {
    V out = torque;
    if (torque.size() < 2) return out;
    for (Eigen::Index k = 0; k < torque.size(); ++k) out(k) = at(torque, static_cast<double>(k) - samples, cubic);
    return out;
  }

  /// Value between samples, held at the ends.
  template <class V>
  static double at(const V& y, double sample, bool cubic) {
    const double place = std::clamp(sample, 0.0, static_cast<double>(y.size() - 1));
    const auto low = std::min(static_cast<Eigen::Index>(place), y.size() - 2);
    const double s = place - static_cast<double>(low);
    // Cubic through four neighbours: a line damps the highest frequencies, which a dead time does not.
    if (!cubic || low < 1 || low + 2 >= y.size()) return (1 - s) * y(low) + s * y(low + 1);
    return y(low - 1) * (-s * (s - 1) * (s - 2) / 6) + y(low) * ((s + 1) * (s - 1) * (s - 2) / 2) +
           y(low + 1) * (-(s + 1) * s * (s - 2) / 2) + y(low + 2) * ((s + 1) * s * (s - 1) / 6);
  }
};

}  // namespace deltadyn::effects
