#pragma once

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Coulomb friction that differs by direction, or an offset of the amplifier: a constant torque c [N m | N] of either
/// sign, |c| below the joint's Coulomb friction if it is friction.
struct AsymmetricCoulomb : JointLaw {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "asymmetric_coulomb";
    t.alias = "torque_offset";
    t.effect_class = EffectClass::quasi_constant;
    t.amplitudes = {{"offset", "{F}"}};
    t.by_direction = true;
    t.form = {0.01, 0.12, 5e-4};  // linear, but friction that differs by direction does so in more ways
    t.base_term = BaseTerm::offset;
    t.meaning = "the drive's torque has a constant offset (amplifier, or Coulomb friction that differs by direction)";
    t.shows = "the same residual at every speed";
    t.remedy = "trim the amplifier's offset, or keep the term";
    return t;
  }

  template <class T>
  static std::array<T, 1> columns(const JointInput<T>&, const Shape<T>&) {
    return {T(1)};
  }
};

}  // namespace deltadyn::effects
