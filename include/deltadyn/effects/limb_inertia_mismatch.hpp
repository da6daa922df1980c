#pragma once

#include <cmath>

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// One limb differs from the others: its upper arm has another first moment along the arm and another inertia about the
/// drive axis (a cable, a gripper valve, a repair). The two columns of a revolute drive for arm parameters (mcx, Iyy),
/// with gravity (gx, gz) outwards and upwards in the limb's frame:
///   d(mcx) (gx sin q + gz cos q)  and  d(Iyy) qdd,   amplitudes [kg m] and [kg m^2] of either sign.
/// Valid as long as the struts stay alike.
struct LimbInertiaMismatch : JointLaw {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "limb_inertia_mismatch";
    t.effect_class = EffectClass::inertia_like;
    t.place = EffectPlace::arm;
    t.amplitudes = {{"moment", "kg*m"}, {"inertia", "kg*m^2"}};
    t.form = {0.01, 5e-4, 5e-4};  // linear in what is known
    t.special_cases = {"rotor_inertia"};
    t.base_term = BaseTerm::limb;
    t.meaning = "one limb has another mass distribution than the others";
    t.shows = "gravity and inertia of one limb";
    t.remedy = "identify with --individual-limbs; look for a cable or a repair on this arm";
    return t;
  }

  template <class T>
  static std::array<T, 2> columns(const JointInput<T>& in, const Shape<T>&) {
    using std::cos;
    using std::sin;
    return {T(in.gravity_x * sin(in.position) + in.gravity_z * cos(in.position)), in.acceleration};
  }
  template <class Machine>
  static void change(Machine& machine, int joint, const std::array<double, kMostAmplitudes>& more,
                     const Shape<double>&) {
    machine.add_to_arm(joint, more[0], more[1]);
  }
};

}  // namespace deltadyn::effects
