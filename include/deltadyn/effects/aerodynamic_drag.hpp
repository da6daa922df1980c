#pragma once

#include <cmath>

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Drag of the plate and what it carries: force c |v| v with the plate's velocity v [m/s]. Amplitude c [N s^2/m^2] > 0:
/// half the density of air times drag coefficient times area. Valid above Re of about 1000 and for air at rest.
struct AerodynamicDrag : PlateForce {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "aerodynamic_drag";
    t.place = EffectPlace::platform;
    t.amplitudes = {{"coefficient", "N*s^2/m^2", Sign::positive}};
    t.meaning = "air drag on the plate";
    t.shows = "grows with the plate's speed squared";
    t.remedy = "keep the term";
    return t;
  }

  template <class T>
  static std::array<Vector3<T>, 1> columns(const PlateInput<T>& in, const Shape<T>&) {
    using std::sqrt;
    return {sqrt(in.velocity.squaredNorm()) * in.velocity};
  }
};

}  // namespace deltadyn::effects
