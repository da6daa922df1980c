#pragma once

#include <cmath>

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Friction in proportion to the transmitted load: mu |tau_load| sign(v), amplitude mu [1], mu > 0; tau_load is what
/// the gear passes on, the rigid model's torque without the drive's own friction [N m | N]. Valid for gears and
/// bearings under load while they slide. Source: Hamon, Gautier, Garrec, IROS 2010.
struct LoadDependentFriction : JointLaw {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "load_dependent_friction";
    t.effect_class = EffectClass::load;
    t.amplitudes = {{"coefficient", "", Sign::positive, 1.0}};
    t.form = {0.06, 0.12, 0.04};  // of the torque on one side of the gear or on the other
    t.meaning = "the drive's friction grows with the torque that it transmits";
    t.shows = "friction that grows with the load";
    t.remedy = "keep it as a feed-forward term; look at the gear's efficiency";
    return t;
  }

  template <class T>
  static std::array<T, 1> columns(const JointInput<T>& in, const Shape<T>&) {
    using std::abs;
    return {T(abs(in.load) * in.sign)};
  }
};

}  // namespace deltadyn::effects
