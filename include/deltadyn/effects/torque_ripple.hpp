#pragma once

#include "deltadyn/effects/kinds.hpp"
#include "deltadyn/effects/wave.hpp"

namespace deltadyn::effects {

/// Ripple of motor and gear over position: a cos(n q) + b sin(n q). Amplitudes a, b [N m | N] of either sign. n > 0 is
/// free [1/rad | 1/m]: cogging has n = gear ratio x slots, tooth meshing n = teeth. Valid while n |v| stays in the pass
/// band. Less than one wave over the range of the drive is no wave but part of one: of gravity, load, anything. Source:
/// Gandhi, Thorby, torque ripple of permanent-magnet drives; Holtz, Springob 1996.
struct TorqueRipple : JointLaw {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "torque_ripple";
    t.effect_class = EffectClass::position_periodic;
    t.amplitudes = {{"cosine", "{F}"}, {"sine", "{F}"}};
    t.shapes = {ShapeTraits("n", "1/{x}", ShapeScale::waves)
                    .among({1, 60})
                    .up_to(1e5)
                    .searched({ShapeSearch::by_difference, 0, 0, 1})};
    t.role = Role::wave;
    t.meaning = "the drive's torque ripples over its position (cogging, tooth meshing)";
    t.shows = "periodic in the position";
    t.remedy = "compensate the ripple over position; n tells the number of poles or teeth";
    return t;
  }

  template <class T>
  static std::array<T, 2> columns(const JointInput<T>& in, const Shape<T>& shape) {
    const Wave<T> parts = wave(in.position, shape[0]);
    return {parts.cosine, parts.sine};
  }
};

}  // namespace deltadyn::effects
