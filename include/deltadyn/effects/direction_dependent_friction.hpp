#pragma once

#include <cmath>

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Coulomb and viscous friction that differ by direction, with a dead zone of the rate in which there is none: the
/// friction slot of real drive firmware (two Coulomb and two viscous values and a rate below which the drive adds
/// nothing). Beside the model's c sign(v) + d v: a + b |v| beyond the dead zone, and -z sign(v) within it. Amplitudes:
/// a [N m | N] and b [N m s/rad | N s/m] of either sign, half the difference of the two directions, so that the slot's
/// values are c + a, c - a, d + b, d - b; z > 0, the Coulomb friction that is missing in the dead zone (z = c: all of
/// it; the viscous part is small there and left out). Shape: rate v0 > 0 of the dead zone's edge; the edge runs from
/// 0.8 to 1.2 v0, as an edge without width could hold a joint at its rate. Valid for joints that slide. Source:
/// robotology/robots-configuration, pull request 599 (viscousPos, viscousNeg, coulombPos, coulombNeg, velocityThres).
struct DirectionDependentFriction : JointLaw {
  static constexpr double kHalfEdge = 0.2;  ///< of v0

  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "direction_dependent_friction";
    t.amplitudes = {
        {"coulomb_difference", "{F}"}, {"viscous_difference", "{F}*s/{x}"}, {"dead_zone", "{F}", Sign::positive}};
    t.shapes = {ShapeTraits("rate", "{x}/s", ShapeScale::largest_rate).from(0.01, 0.16, 5).up_to(1e3)};
    t.by_direction = true;
    t.special_cases = {"asymmetric_coulomb", "asymmetric_viscous"};
    // Its four free numbers follow what is not straight in friction of one difference, too
    t.simpler_gain = 0.8;
    t.form = {0.03, 0.12, 5e-4};  // friction that differs by direction does so in more ways, as `asymmetric_coulomb`
    t.meaning = "the drive's Coulomb and viscous friction differ by direction, with none at the lowest rates";
    t.shows = "residual that depends on the direction, but not below a rate";
    t.remedy = "keep it as a feed-forward term: it is what the friction slot of a drive's firmware takes";
    return t;
  }

  template <class T>
  static std::array<T, 3> columns(const JointInput<T>& in, const Shape<T>& shape) {
    using std::abs;
    const T speed = abs(in.rate);
    const T across = (speed / shape[0] - T(1 - kHalfEdge)) / T(2 * kHalfEdge);
    const T x = across > T(0) ? (across < T(1) ? across : T(1)) : T(0);
    const T beyond = x * x * (T(3) - T(2) * x);
    return {beyond, T(beyond * speed), T((beyond - T(1)) * in.sign)};
  }
};

}  // namespace deltadyn::effects
