#pragma once

#include <cmath>

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Loss of a gear whose efficiency differs between driving (the motor feeds power, tau_load v > 0) and back-driving.
/// Two columns: |tau_load| sign(v) where the gear drives, and where it is driven. Amplitudes [1], both > 0: 1/eta_d - 1
/// when driving, 1 - eta_b when back-driving; equal amplitudes are `load_dependent_friction`, with tau_load as there.
/// Valid without play. Source: Wang, Yang, et al., worm and screw drives; Giberti, Cinquemani, Legnani 2010.
struct DirectionalEfficiency : JointLaw {
  static constexpr double kSameLoss = 0.5;  ///< smaller over larger loss of a gear from which both count as one

  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "directional_efficiency";
    t.effect_class = EffectClass::load;
    t.amplitudes = {{"driving_loss", "", Sign::positive, 1.0}, {"back_driving_loss", "", Sign::positive, 1.0}};
    t.form = {0.06, 0.12, 0.04};  // as `load_dependent_friction`
    t.meaning = "the drive's gear loses different shares when it drives and when it is driven";
    t.shows = "follows the sign of torque times speed";
    t.remedy = "keep it as a feed-forward term";
    t.special_cases = {"load_dependent_friction"};
    t.nearly_special = [](const double* loss) {
      return (loss[0] < loss[1] ? loss[0] : loss[1]) > kSameLoss * (loss[0] < loss[1] ? loss[1] : loss[0]);
    };
    return t;
  }

  template <class T>
  static std::array<T, 2> columns(const JointInput<T>& in, const Shape<T>&) {
    using std::abs;
    const T loss = abs(in.load) * in.sign;
    const bool drives = in.load * in.sign > T(0);
    return {drives ? loss : T(0), drives ? T(0) : loss};
  }
};

}  // namespace deltadyn::effects
