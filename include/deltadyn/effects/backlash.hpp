#pragma once

#include <cmath>

#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Play in a drive's gear, seen from the motor's encoder: after the load reverses, the motor crosses the gap alone and
/// the rigid model's load is missing: torque -A tau_load while in the gap, 0 <= A <= 1 (1: all of the load hangs behind
/// the gap). State: the motor's place in the gap, x in [-b/2, b/2]; it moves with the motor and stops at the side that
/// the load presses on. Shape: gap b > 0 [rad | m], 1e-4 to 0.05 rad. Valid for stiff flanks without bounce. Source:
/// Nordin, Gutman, Automatica 38, 2002.
struct Backlash : JointMemory {
  // What the one number leaves open about real play.
  /// A motor much lighter than its load cannot be controlled across it
  static constexpr double kLeastMotorShare = 0.3;
  static constexpr double kFlankFrequencyHz = 250;  ///< resonance of motor and load while a flank carries

  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "backlash";
    t.effect_class = EffectClass::reversal_memory;
    t.amplitudes = {{"share", "", Sign::positive, 1.0}};
    t.shapes = {ShapeTraits("gap", "{x}", ShapeScale::displacement).from(5e-4, 0.05, 6).up_to(1)};
    t.memory = true;
    t.form = {0.03, 0.25, 0.06};
    t.meaning = "the drive's gear has play";
    t.shows = "torque missing after the load reverses";
    t.remedy = "readjust the gear";
    return t;
  }

  template <class T>
  static T start(const T&, const Shape<T>& shape) {
    return shape[0] / T(2);
  }
  template <class T>
  static T moved(const T& place, const T& step, const JointInput<T>& in, const Shape<T>& shape) {
    using std::abs;
    const T carries = flank(in.load, shape);
    if (place == carries) return place;  // the load presses the flank: motor and load move together
    // A free motor moves by its own step; what crosses the gap is that step and, if it runs the other way, its size.
    const T next = place + (in.load > T(0) ? abs(step) : -abs(step));
    return abs(next) > abs(carries) ? carries : next;
  }
  template <class T>
  static std::array<T, 1> columns(const T& place, const JointInput<T>& in, const Shape<T>& shape) {
    return {place == flank(in.load, shape) ? T(0) : T(-in.load)};
  }

  template <class Machine>
  static void change(Machine& machine, int joint, const std::array<double, kMostAmplitudes>& share,
                     const Shape<double>& shape) {
    SpringInDrive spring;
    spring.motor_share = 1 - share[0] > kLeastMotorShare ? 1 - share[0] : kLeastMotorShare;
    spring.flank_hz = kFlankFrequencyHz;
    spring.gap = shape[0];
    machine.soften(joint, spring);
  }

 private:
  /// Side that carries: with load > 0 the motor has to push in the positive direction.
  template <class T>
  static T flank(const T& load, const Shape<T>& shape) {
    return load > T(0) ? T(shape[0] / T(2)) : T(-shape[0] / T(2));
  }
};

}  // namespace deltadyn::effects
