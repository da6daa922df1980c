#pragma once

#include "deltadyn/effects/kinds.hpp"
#include "deltadyn/effects/wave.hpp"

namespace deltadyn::effects {

/// Coulomb friction that varies over a turn: (a cos(n q) + b sin(n q)) sign(v) beside Fc sign(v), by eccentric wheels
/// and uneven preload. Amplitudes a, b [N m | N] of either sign, together below Fc; n > 0 [1/rad | 1/m], mostly a small
/// integer: friction varies over a turn, not over a tooth, and once a turn shows as part of a wave. Flips with the
/// direction, which `torque_ripple` does not. Source: Armstrong-Helouvry, Control of Machines with Friction, 1991.
struct PositionDependentFriction : JointLaw {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "position_dependent_friction";
    t.effect_class = EffectClass::position_periodic;
    t.amplitudes = {{"cosine", "{F}"}, {"sine", "{F}"}};
    t.shapes = {
        ShapeTraits("n", "1/{x}", ShapeScale::waves).among({1, 10}).up_to(1e4).searched({ShapeSearch::by_difference})};
    t.meaning = "the drive's Coulomb friction varies over its position";
    t.shows = "periodic in the position, flips with the direction";
    t.remedy = "look for an eccentric wheel or uneven preload";
    return t;
  }

  template <class T>
  static std::array<T, 2> columns(const JointInput<T>& in, const Shape<T>& shape) {
    const Wave<T> parts = wave(in.position, shape[0]);
    return {T(parts.cosine * in.sign), T(parts.sine * in.sign)};
  }
};

}  // namespace deltadyn::effects
