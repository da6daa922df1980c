#pragma once

#include <cmath>

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Viscous friction that differs by direction: b |v| beside the mean d v, so that d + b holds for v > 0 and d - b for v
/// < 0. Amplitude b [N m s/rad | N s/m] of either sign, |b| < d. Source: Janot, Gautier, Brunot 2019 (EMPS, a screw
/// axis).
struct AsymmetricViscous : JointLaw {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "asymmetric_viscous";
    t.amplitudes = {{"viscous", "{F}*s/{x}"}};
    t.by_direction = true;
    t.form = {0.01, 0.12, 5e-4};  // as `asymmetric_coulomb`
    t.meaning = "the drive's viscous friction differs by direction";
    t.shows = "residual even in the speed";
    t.remedy = "keep it as a feed-forward term";
    return t;
  }

  template <class T>
  static std::array<T, 1> columns(const JointInput<T>& in, const Shape<T>&) {
    return {T(in.rate * in.sign)};
  }
};

}  // namespace deltadyn::effects
