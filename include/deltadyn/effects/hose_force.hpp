#pragma once

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Hose or cable on the plate: a force f0 + K r that depends on the plate's place r only, with stiffnesses along the
/// base's axes. Amplitudes: f0 [N] of either sign, the force at the origin of the base; K [N/m] > 0; along x, y, z
/// each. f0 along z is borne as a change of the plate's mass would be. Valid for slack loops that hang softly; no
/// damping, no hysteresis.
struct HoseForce : PlateForce {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "hose_force";
    t.effect_class = EffectClass::pose_force;
    t.place = EffectPlace::platform;
    t.amplitudes = {{"force_x", "N"},
                    {"force_y", "N"},
                    {"force_z", "N"},
                    {"stiffness_x", "N/m", Sign::positive},
                    {"stiffness_y", "N/m", Sign::positive},
                    {"stiffness_z", "N/m", Sign::positive}};
    t.form = {0.03, 3e-3, 3e-3};
    t.meaning = "a force on the plate that depends on its place only (hose, cable, balancing spring)";
    t.shows = "pose only";
    t.remedy = "route the hose or cable loosely, or keep the term";
    return t;
  }

  template <class T>
  static std::array<Vector3<T>, 6> columns(const PlateInput<T>& in, const Shape<T>&) {
    std::array<Vector3<T>, 6> columns;
    for (int axis = 0; axis < 3; ++axis) {
      columns[static_cast<std::size_t>(axis)] = Vector3<T>::Unit(axis);
      columns[static_cast<std::size_t>(3 + axis)] = in.position(axis) * Vector3<T>::Unit(axis);
    }
    return columns;
  }
};

}  // namespace deltadyn::effects
