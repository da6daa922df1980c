#pragma once

#include <cmath>

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Viscous friction that grows faster than the rate: Fq |v|^a sign(v), a > 1 (1.5 to 3), amplitude Fq [N m | N] at 1
/// rad/s or 1 m/s, Fq > 0. Churning losses of oil and turbulent films; on the plate see `aerodynamic_drag`. Source:
/// Niemann, Winter, Maschinenelemente 2, 2003, load-independent losses.
struct ConvexViscous : JointLaw {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "convex_viscous";
    t.amplitudes = {{"friction", "{F}", Sign::positive}};
    t.shapes = {ShapeTraits("exponent", "")
                    .among({1.5, 2, 3})
                    .within(1, 6)
                    .searched({ShapeSearch::by_difference, -0.5, 0.7, 1.2})};
    t.meaning = "the drive's friction grows faster than its speed";
    t.shows = "excess of friction at high speed";
    t.remedy = "keep it as a feed-forward term; look at the oil level or a fan on the motor shaft";
    t.course = [](const double*) { return Course::open; };
    return t;
  }

  template <class T>
  static std::array<T, 1> columns(const JointInput<T>& in, const Shape<T>& shape) {
    using std::abs;
    using std::pow;
    const T x = abs(in.rate);
    return {x > T(0) ? T(pow(x, shape[0]) * in.sign) : T(0)};
  }
};

}  // namespace deltadyn::effects
