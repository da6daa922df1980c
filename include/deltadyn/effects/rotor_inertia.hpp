#pragma once

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Inertia of rotor and gear of one drive beside what the model has: torque dI qdd, amplitude dI [kg m^2 | kg] of
/// either sign, as seen at the output. Leaves out the gyroscopic torque of a rotor whose axis moves; the drives of a
/// Delta stand on the base, so there is none.
struct RotorInertia : JointLaw {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "rotor_inertia";
    t.effect_class = EffectClass::inertia_like;
    t.amplitudes = {{"inertia", "{F}*s^2/{x}"}};
    t.form = {0.01, 5e-4, 5e-4};  // linear in what is known
    t.base_term = BaseTerm::rotor_inertia;
    t.meaning = "one drive has another inertia than the others (rotor, gear, coupling)";
    t.shows = "in proportion to one drive's acceleration";
    t.remedy = "identify with --rotor-inertia for this drive";
    return t;
  }

  template <class T>
  static std::array<T, 1> columns(const JointInput<T>& in, const Shape<T>&) {
    return {in.acceleration};
  }
  template <class Machine>
  static void change(Machine& machine, int joint, const std::array<double, kMostAmplitudes>& inertia,
                     const Shape<double>&) {
    machine.add_rotor(joint, inertia[0]);
  }
};

}  // namespace deltadyn::effects
