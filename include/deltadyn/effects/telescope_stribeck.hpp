#pragma once

#include "deltadyn/effects/stribeck.hpp"

namespace deltadyn::effects {

/// Stribeck effect of the telescope bar's prismatic joint: `stribeck` of the bar's rate, borne by the drives through
/// the Jacobian of its length. Amplitude dF [N] > 0, shape rate [m/s] and exponent.
struct TelescopeStribeck : JointLaw {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "telescope_stribeck";
    t.place = EffectPlace::telescope;
    t.amplitudes = {{"friction", "N", Sign::positive}};
    t.shapes = {ShapeTraits("rate", "m/s", ShapeScale::largest_rate).from(0.004, 0.4, 7).up_to(1e3),
                ShapeTraits("exponent", "").among({1, 2}).within(0.1, 10).searched({ShapeSearch::fixed})};
    t.meaning = "the telescope bar has more friction at low speed";
    t.shows = "follows the sign of the bar's rate";
    t.remedy = "lubricate the bar";
    return t;
  }

  template <class T>
  static std::array<T, 1> columns(const JointInput<T>& in, const Shape<T>& shape) {
    return Stribeck::columns(in, shape);
  }
};

}  // namespace deltadyn::effects
