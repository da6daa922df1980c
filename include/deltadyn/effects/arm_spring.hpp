#pragma once

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// A linear spring between the base and an arm or carriage, which makers add to relieve the gears: torque k (q - q0).
/// Amplitude: stiffness k > 0 [N m/rad | N/m]; shape: its zero q0 [rad | m], where it pulls neither way. On one limb or
/// on all alike. A counterweight in its place is a part of the arm and needs no effect: the arm's own parameters hold
/// it. Valid within the spring's straight range.
struct ArmSpring : JointLaw {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "arm_spring";
    t.effect_class = EffectClass::pose_force;
    t.place = EffectPlace::limb_or_all;
    t.amplitudes = {{"stiffness", "{F}/{x}", Sign::positive}};
    t.shapes = {ShapeTraits("zero", "{x}", ShapeScale::place).among({-1.5, -0.75, 0, 0.75, 1.5}).within(-100, 100)};
    t.form = {0.03, 3e-3, 3e-3};  // springs are not quite straight, as `hose_force`
    t.meaning = "a spring between base and arm pulls the drive";
    t.shows = "grows in proportion to the drive's position";
    t.remedy = "keep the term; check the spring's zero and stiffness against its data sheet";
    return t;
  }

  template <class T>
  static std::array<T, 1> columns(const JointInput<T>& in, const Shape<T>& shape) {
    return {T(in.position - shape[0])};
  }
};

}  // namespace deltadyn::effects
