#pragma once

#include <cmath>

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Stribeck effect: dF exp(-|v/vs|^delta) sign(v), amplitude dF [N m | N], dF > 0: more friction at low speed than
/// Coulomb's law says. Shape: Stribeck rate vs > 0, where the lubricant begins to carry [rad/s | m/s], 0.5 % to 50 % of
/// the largest rate; exponent delta, 1 (Tustin), 2 (Gauss), 0.5 (Armstrong-Helouvry). Valid for a joint that slides; at
/// rest and just after a reversal `presliding` rules. Source: Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica
/// 30(7), 1994, section 2.
struct Stribeck : JointLaw {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "stribeck";
    t.amplitudes = {{"friction", "{F}", Sign::positive}};
    t.shapes = {ShapeTraits("rate", "{x}/s", ShapeScale::largest_rate).from(0.004, 0.4, 9).up_to(1e3),
                ShapeTraits("exponent", "").among({1, 2}).within(0.1, 10).searched({ShapeSearch::fixed})};
    t.meaning = "the drive has more friction at low speed than Coulomb's law says (Stribeck effect)";
    t.shows = "excess of friction at low speed";
    t.remedy = "keep it as a feed-forward term; check the lubricant if it is large";
    return t;
  }

  template <class T>
  static std::array<T, 1> columns(const JointInput<T>& in, const Shape<T>& shape) {
    using std::abs;
    using std::exp;
    using std::pow;
    return {T(exp(-pow(T(abs(in.rate) / shape[0]), shape[1])) * in.sign)};
  }
};

}  // namespace deltadyn::effects
