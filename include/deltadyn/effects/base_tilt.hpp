#pragma once

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// The base is not level: gravity turned by the small angles delta_x, delta_y about the base's axes, g' = g + delta x
/// g. Amplitudes: the two angles [rad] of either sign, below 0.1. Valid for small angles (second order left out).
struct BaseTilt : MachineChange {
  static constexpr double kStep = 1e-3;  ///< [rad]

  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "base_tilt";
    t.effect_class = EffectClass::pose_force;
    t.place = EffectPlace::robot;
    t.amplitudes = {{"angle_x", "rad", Sign::either, 0.3}, {"angle_y", "rad", Sign::either, 0.3}};
    t.form = {0.01, 3e-3, 3e-3};  // the first term of a series
    t.meaning = "the base is not level";
    t.shows = "a fixed pattern of gravity over the drives";
    t.remedy = "level the base, or state gravity's direction";
    return t;
  }

  template <class Machine>
  static void change(Machine& machine, int, const std::array<double, kMostAmplitudes>& angle, const Shape<double>&) {
    machine.tilt(angle[0], angle[1]);
  }
};

}  // namespace deltadyn::effects
