#pragma once

#include <cmath>

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Shear-thinning grease: a deficit of friction at low speed beside a straight line through the high speeds, as drive 4
/// of the paper (VIII.C) has it. Amplitude dF [N m | N], dF > 0. Shape: rate v0 > 0 [rad/s | m/s], 1 % to 100 % of the
/// largest rate; exponent a: 0 is the exponential law -dF exp(-|v|/v0) sign(v), Coulomb friction that builds up with
/// speed; 0 < a < 1 is the power law dF |v/v0|^a sign(v), in which v0 is a unit only. Valid in the full lubricant film
/// at constant temperature. Source: Ostwald-de Waele power law; Hamrock, Fundamentals of Fluid Film Lubrication, 2004,
/// chapter 4.
struct ShearThinning : JointLaw {
  static constexpr double kRestShare = 0.03;  ///< of the largest rate: friction that bends below it is friction at rest

  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "shear_thinning";
    t.amplitudes = {{"friction", "{F}", Sign::positive}};
    t.shapes = {ShapeTraits("rate", "{x}/s", ShapeScale::largest_rate).from(0.01, 1.0, 7).up_to(1e3),
                ShapeTraits("exponent", "").among({0, 0.3, 0.5, 0.7}).within(0, 0.99).searched({ShapeSearch::fixed})};
    t.meaning =
        "the drive's friction bends over: it lacks friction at low speed beside a straight line (grease that thins)";
    t.shows = "deficit of friction at low speed";
    t.remedy = "keep it as a feed-forward term; do not tune Coulomb and viscous friction by hand instead";
    t.is_unit = [](std::size_t parameter, const double* shape) { return parameter == 0 && shape[1] > 0; };
    t.only_near_rest = [](const double* shape, double largest_rate) {
      return !(shape[1] > 0) && shape[0] < kRestShare * largest_rate;
    };
    t.course = [](const double* shape) { return shape[1] > 0 ? Course::endless : Course::ends_at_rate; };
    return t;
  }

  template <class T>
  static std::array<T, 1> columns(const JointInput<T>& in, const Shape<T>& shape) {
    using std::abs;
    using std::exp;
    using std::pow;
    const T x = abs(in.rate) / shape[0];
    if (shape[1] > T(0)) return {x > T(0) ? T(pow(x, shape[1]) * in.sign) : T(0)};
    return {T(-exp(-x) * in.sign)};
  }
};

}  // namespace deltadyn::effects
