#pragma once

#include <cmath>

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Torque that the motor does not reach at its peaks: what lies above `level` comes out reduced by the share A, 0 < A
/// <= 1 (1: cut off, below 1: magnetic saturation softens it). A < 0 where the log holds the command, which then
/// exceeds the motor's torque. level > 0 [N m | N], 50 % to 95 % of the largest torque: far below the peaks it would be
/// a matter of gain or load. Tells itself from a gain error by leaving the small torques alone.
struct Saturation : RecordedChange {
  static constexpr int kStage = 0;

  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "saturation";
    t.effect_class = EffectClass::load;
    t.amplitudes = {{"share", "", Sign::either, 1.0}};
    t.shapes = {ShapeTraits("level", "{F}", ShapeScale::largest_torque)
                    .among({0.5, 0.6, 0.7, 0.8, 0.88, 0.94})
                    .searched({ShapeSearch::by_factor, 0.9, 1.1})};
    t.meaning = "the drive does not reach its torque peaks";
    t.shows = "at the peaks only";
    t.remedy = "lower the acceleration, or check the current limit";
    return t;
  }

  template <class V>
  static V record(const V& torque, double, double share, const Shape<double>& shape) {
    return torque.unaryExpr([share, level = shape[0]](double tau) {
      const double beyond = std::abs(tau) - level;
      return beyond > 0 ? tau - share * (tau > 0 ? beyond : -beyond) : tau;
    });
  }
};

}  // namespace deltadyn::effects
