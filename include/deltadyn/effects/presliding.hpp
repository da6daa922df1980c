#pragma once

#include "deltadyn/effects/bristle.hpp"
#include "deltadyn/effects/kinds.hpp"

namespace deltadyn::effects {

/// Presliding friction: after a reversal the friction builds up over a displacement instead of jumping. For a joint
/// that has a Coulomb column already the effect is Fc (z + T dz/dt - sign v), amplitude Fc > 0 [N m | N]; state z and
/// damping T as bristle.hpp has them. Shape: displacement x_s > 0 [rad | m], damping T >= 0 [s].
struct Presliding : JointMemory {
  static constexpr EffectTraits traits() {
    EffectTraits t;
    t.name = "presliding";
    t.effect_class = EffectClass::reversal_memory;
    t.amplitudes = {{"friction", "{F}", Sign::positive}};
    t.shapes = {ShapeTraits("displacement", "{x}", ShapeScale::displacement).from(3e-4, 0.08, 7).up_to(1),
                ShapeTraits("damping", "s").among({0}).within(0, 10).searched({ShapeSearch::fixed}).else_is(0)};
    t.memory = true;
    t.form = {0.03, 0.25, 0.06};
    t.role = Role::bristle;
    t.meaning = "after a reversal the drive's friction builds up over a displacement instead of jumping";
    t.shows = "memory after a reversal";
    t.remedy = "use a friction model with a state (LuGre) near reversals";
    return t;
  }

  template <class T>
  static T start(const T& sign, const Shape<T>&) {
    return sign;
  }
  template <class T>
  static T moved(const T& state, const T& step, const JointInput<T>&, const Shape<T>& shape) {
    return Bristle<T>(shape[0], state).move(step);
  }
  template <class T>
  static std::array<T, 1> columns(const T& state, const JointInput<T>& in, const Shape<T>& shape) {
    return {T(damped_bristle(in.rate, state, shape[0], shape[1]) - in.sign)};
  }
};

}  // namespace deltadyn::effects
