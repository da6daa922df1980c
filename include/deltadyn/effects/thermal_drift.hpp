#pragma once

#include <cmath>

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Viscous friction that falls while the grease warms up: d (1 + b exp(-t/T)) v beside d v. Column: v exp(-t/T),
/// amplitude d b [N m s/rad | N s/m], > 0 for a cold start; T > 0 [s], seconds to minutes, t since the start of the
/// log. Valid for one thermal time constant. Source: Simoni et al., Robotica 33, 2015 (friction and temperature).
struct ThermalDrift : JointLaw {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "thermal_drift";
    t.effect_class = EffectClass::drift;
    t.amplitudes = {{"viscous", "{F}*s/{x}", Sign::positive}};
    t.shapes = {ShapeTraits("time_constant", "s").from(1.5, 60, 6).up_to(1e6)};
    t.meaning = "the drive's viscous friction falls while it warms up";
    t.shows = "slow trend in proportion to the speed";
    t.remedy = "warm the drives up before recording";
    return t;
  }

  template <class T>
  static std::array<T, 1> columns(const JointInput<T>& in, const Shape<T>& shape) {
    using std::exp;
    return {T(in.rate * exp(-in.time / shape[0]))};
  }
};

}  // namespace deltadyn::effects
