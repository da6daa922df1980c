#pragma once

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// A wrong torque constant of one drive: the torque that the log states is (1 + eps) times the true one; amplitude eps
/// [1] of either sign, |eps| < 0.5. The same error on all drives scales every parameter and cannot be seen.
struct TorqueConstantError : RecordedChange {
  static constexpr int kStage = 1;

  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "torque_constant_error";
    t.effect_class = EffectClass::load;
    t.amplitudes = {{"share", "", Sign::either, 0.5}};
    t.form = {0.01, 5e-4, 5e-4};  // linear in what is known
    t.base_term = BaseTerm::torque_scale;
    t.meaning = "one drive's torque constant is wrong";
    t.shows = "in proportion to the drive's torque";
    t.remedy = "check the torque constant of this drive";
    return t;
  }

  template <class V>
  static V record(const V& torque, double, double share, const Shape<double>&) {
    return (1 + share) * torque;
  }
};

}  // namespace deltadyn::effects
