#pragma once

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Coulomb friction of the ball and universal joints, the same in each: power mu sum |w| over the joints' two angles
/// each, so that the drives bear mu sum sign(w) dw/dqd. Amplitude mu [N m] > 0. Valid for preload that does not change
/// with the pose. Source: paper II.A (balls as two revolute joints), Coulomb's law in each;
/// kinematics/passive_joints.hpp counts them.
struct PassiveJointFriction : JointLaw {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "passive_joint_friction";
    t.place = EffectPlace::passive_joints;
    t.amplitudes = {{"friction", "N*m", Sign::positive}};
    t.meaning = "the ball and universal joints have friction";
    t.shows = "couples all drives";
    t.remedy = "keep the term; check the preload of the balls";
    return t;
  }

  template <class T>
  static std::array<T, 1> columns(const JointInput<T>& in, const Shape<T>&) {
    return {in.sign};
  }
};

}  // namespace deltadyn::effects
