#pragma once

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Friction of the telescope bar's guide under side load: mu |n| sign(l_d), borne by the drives through the Jacobian of
/// the bar's length. The side load per unit mass n is what the bar's plate-end needs across the bar: (a - g) without
/// its part along the bar. Amplitude: mu times the mass that the guide carries across [kg] > 0. Valid for a bar that is
/// stiff beside its guide.
struct TelescopeSideLoad : JointLaw {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "telescope_side_load";
    t.effect_class = EffectClass::load;
    t.place = EffectPlace::telescope;
    t.amplitudes = {{"coefficient", "kg", Sign::positive}};
    t.meaning = "the telescope bar's friction grows with its side load";
    t.shows = "grows with the force across the bar";
    t.remedy = "check the bar's guide";
    return t;
  }

  template <class T>
  static std::array<T, 1> columns(const JointInput<T>& in, const Shape<T>&) {
    return {T(in.side_load * in.sign)};
  }
};

}  // namespace deltadyn::effects
