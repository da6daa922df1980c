#pragma once

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// A geometry parameter kappa that is not what the robot file says: the torque changes by d(Y p)/d(kappa) per unit.
/// Shape `kind`: 0 the home position of a drive (q + delta in place of q [rad | m]), 1 an arm's length (of a carriage
/// its home, too), 2 a strut's length [m]. Amplitude of either sign: below 0.05 rad, 1 % of a length. Valid to first
/// order.
struct KinematicOffset : MachineChange {
  static constexpr double kStep = 1e-4;  ///< [rad | m]

  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "kinematic_offset";
    t.effect_class = EffectClass::pose_force;
    t.place = EffectPlace::limb;
    t.amplitudes = {{"error", "SI", Sign::either, 1.0}};
    t.shapes = {ShapeTraits("kind", "", ShapeScale::choice).among({0, 1, 2})};
    t.form = {0.03, 3e-3, 3e-3};  // the first term of a series
    t.meaning = "a length or a home position is not what the robot file says (kind 0 home, 1 arm, 2 strut)";
    t.shows = "gravity that depends on the pose";
    t.remedy = "calibrate the home position and the lengths";
    return t;
  }

  template <class Machine>
  static void change(Machine& machine, int joint, const std::array<double, kMostAmplitudes>& error,
                     const Shape<double>& shape) {
    if (shape[0] < 0.5) {
      machine.shift_home(joint, error[0]);
    } else if (shape[0] < 1.5) {
      machine.lengthen_arm(joint, error[0]);
    } else {
      machine.lengthen_strut(joint, error[0]);
    }
  }
};

}  // namespace deltadyn::effects
