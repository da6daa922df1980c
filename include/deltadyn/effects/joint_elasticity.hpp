#pragma once

#include <cmath>

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// A spring of stiffness k between motor and arm. To first order in 1/k (Spong, J. Dyn. Sys. Meas. Control 109, 1987,
/// expands in it) the motor leads the arm by tau/k, tau being the torque that passes the spring. With the encoder on
/// the arm (encoder = 0) the motor's inertia alone feels it: the drive's torque grows by J_motor/k d2(tau)/dt2,
/// amplitude J_motor/k [s^2]. With the encoder on the motor (encoder = 1) the arm lags behind what is measured, and all
/// drives feel it: the torques of the rigid model fall by its derivative along that lag, amplitude J_arm/k [s^2].
/// motor_share: the motor's share of the drive's inertia, between 0 and 1. Valid well below the resonance sqrt(k/J).
struct JointElasticity : ElasticJoint {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "joint_elasticity";
    t.effect_class = EffectClass::inertia_like;
    t.amplitudes = {{"inertia_over_stiffness", "s^2", Sign::positive, 0.1}};
    t.shapes = {ShapeTraits("encoder", "", ShapeScale::choice).among({0, 1}).else_is(0),
                ShapeTraits("motor_share", "").among({0.4}).within(0.01, 0.99).else_is(0.4)};
    t.form = {0.15, 0.06, 0.06};  // the first term of a series that converges slowly
    t.meaning = "the drive's gear or arm yields like a spring";
    t.shows = "error that grows with the frequency squared";
    t.remedy = "keep the motion below the resonance, or use the elastic model";
    t.resonance_hz = [](const double* amplitude) {
      return 0.15915494309189535 / std::sqrt(std::abs(amplitude[0]) > 1e-300 ? std::abs(amplitude[0]) : 1e-300);
    };
    return t;
  }

  template <class T>
  static T column(const ElasticInput<T>& in, const Shape<T>& shape) {
    const T motor = shape[1] * in.inertia;
    const T torque_dd = in.load_dd - motor * in.snap;
    if (!(shape[0] > T(0.5))) return in.own ? torque_dd : T(0);
    const T along_lag = in.load_lag - shape[1] * in.inertia_lag;
    return ((in.own ? motor * torque_dd : T(0)) - along_lag) / (in.inertia - motor);
  }

  template <class Machine>
  static void change(Machine& machine, int joint, const std::array<double, kMostAmplitudes>& amplitude,
                     const Shape<double>& shape) {
    if (amplitude[0] == 0) return;
    SpringInDrive spring;
    spring.motor_share = shape[1];
    spring.inertia_over_stiffness = amplitude[0];
    spring.encoder_on_motor = shape[0] > 0.5;
    machine.soften(joint, spring);
  }
};

}  // namespace deltadyn::effects
