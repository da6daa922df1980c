#include "deltadyn/simulation/friction_law.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "deltadyn/effects/asymmetric_coulomb.hpp"
#include "deltadyn/effects/asymmetric_viscous.hpp"
#include "deltadyn/effects/convex_viscous.hpp"
#include "deltadyn/effects/coulomb_friction.hpp"
#include "deltadyn/effects/directional_efficiency.hpp"
#include "deltadyn/effects/load_dependent_friction.hpp"
#include "deltadyn/effects/position_dependent_friction.hpp"
#include "deltadyn/effects/presliding.hpp"
#include "deltadyn/effects/shear_thinning.hpp"
#include "deltadyn/effects/stribeck.hpp"
#include "deltadyn/effects/telescope_stribeck.hpp"
#include "deltadyn/effects/thermal_drift.hpp"
#include "deltadyn/effects/torque_ripple.hpp"
#include "deltadyn/effects/viscous_friction.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

/// The rate, but never of the other sign: within one integration step a joint slides in one direction.
double sliding_rate(const JointMotion& motion) {
  constexpr double kLeast = std::numeric_limits<double>::min();
  return motion.direction * std::max(motion.direction * motion.rate, kLeast);
}

}  // namespace

bool FrictionLaw::takes(EffectId id) {
  switch (id) {
    case EffectId::stribeck:
    case EffectId::shear_thinning:
    case EffectId::convex_viscous:
    case EffectId::asymmetric_coulomb:
    case EffectId::asymmetric_viscous:
    case EffectId::load_dependent_friction:
    case EffectId::directional_efficiency:
    case EffectId::presliding:
    case EffectId::hysteresis:
    case EffectId::torque_ripple:
    case EffectId::position_dependent_friction:
    case EffectId::thermal_drift:
    case EffectId::telescope_stribeck:
    case EffectId::telescope_side_load: return true;
    default: return false;
  }
}

void FrictionLaw::add(const Effect& effect) {
  const std::string& name = effect_kind(effect.id).name;
  const std::string where = name + "@" + effect_joint_name(effect.id, effect.joint);
  const double first = effect.amplitude(0);
  switch (effect.id) {
    case EffectId::load_dependent_friction:
      driving_ += first;
      back_driving_ += first;
      break;
    case EffectId::directional_efficiency:
      driving_ += first;
      back_driving_ += effect.amplitude(1);
      break;
    case EffectId::presliding:
      if (bristle_ > 0) throw Error("presliding is given twice for one joint", where, "give it once", ExitCode::usage);
      bristle_ = first;
      bristle_displacement_ = effect.shape(0);
      bristle_damping_ = effect.shape.size() > 1 ? effect.shape(1) : 0.0;
      break;
    case EffectId::hysteresis:
      if (loop_) throw Error("hysteresis is given twice for one joint", where, "give it once", ExitCode::usage);
      loop_ = std::make_shared<const Effect>(effect);
      break;
    default: effects_.push_back(effect); break;
  }
  side_load_ = side_load_ || effect.id == EffectId::telescope_side_load;
  jumps_ = jumps_ || (effect.id != EffectId::torque_ripple && effect.id != EffectId::asymmetric_coulomb &&
                      effect.id != EffectId::thermal_drift && effect.id != EffectId::convex_viscous);
  if (!(back_driving_ < 1)) {
    throw Error(fmt::format("a gear that loses {} of the load cannot be driven back at all", back_driving_), where,
                "give a share below 1", ExitCode::usage);
  }
  // At rest friction must resist both ways, at every position.
  JointMotion up, down;
  up.direction = 1;
  down.direction = -1;
  for (int k = 0; k < 64; ++k) {
    up.position = down.position = 0.1 * k;
    if (resistance(up) - resistance(down) < -1e-9 * (coulomb_ + std::abs(first))) {
      throw Error(fmt::format("with {} N m (N) the friction at rest would push instead of hold", first), where,
                  fmt::format("the joint's Coulomb friction is {}; give the effect a smaller amplitude", coulomb_),
                  ExitCode::usage);
    }
  }
}

double FrictionLaw::effect_force(const Effect& effect, double rate, const JointMotion& motion) const {
  const auto a = [&effect](Eigen::Index k) { return effect.amplitude(k); };
  const auto s = [&effect](Eigen::Index k) { return effect.shape(k); };
  switch (effect.id) {
    case EffectId::stribeck: return a(0) * stribeck<double>(rate, {s(0), s(1)});
    case EffectId::shear_thinning:
      // Exponent 0 is the exponential law, as in the catalogue.
      return a(0) * shear_thinning<double>(rate, {s(0), s(1)}, s(1) > 0 ? ShearLaw::power : ShearLaw::exponential);
    case EffectId::convex_viscous: return a(0) * convex_viscous(rate, s(0));
    case EffectId::asymmetric_coulomb: return a(0) * asymmetric_coulomb<double>();
    case EffectId::asymmetric_viscous: return a(0) * asymmetric_viscous(rate);
    case EffectId::torque_ripple: {
      const auto wave = torque_ripple(motion.position, s(0));
      return a(0) * wave.cosine + a(1) * wave.sine;
    }
    case EffectId::position_dependent_friction: {
      const auto wave = position_dependent_friction(motion.position, rate, s(0));
      return a(0) * wave.cosine + a(1) * wave.sine;
    }
    case EffectId::thermal_drift: return a(0) * thermal_drift(rate, motion.time, s(0));
    case EffectId::telescope_stribeck: return a(0) * telescope_stribeck<double>(rate, {s(0), s(1)});
    // The side load is a length already; the formula of effects/telescope_side_load.hpp gave it.
    case EffectId::telescope_side_load: return a(0) * motion.side_load * coulomb_friction(rate);
    default: return 0;
  }
}

double FrictionLaw::resistance(const JointMotion& motion) const {
  const double rate = sliding_rate(motion);
  double force = viscous_ * viscous_friction(rate) + coulomb_ * coulomb_friction(rate);
  for (const Effect& effect : effects_) force += effect_force(effect, rate, motion);
  if (bristle_ > 0) {
    force +=
        bristle_ * (damped_presliding(rate, motion.bristle, bristle_displacement_, bristle_damping_) - coulomb_friction(rate));
  }
  if (loop_) force += loop_->amplitude(0) * motion.loop;
  return force;
}

// tau = load + resistance + |load| s share, with the share that holds for the sign of load s.
double FrictionLaw::required(double load, const JointMotion& motion) const {
  double tau = load + resistance(motion);
  if (driving_ != 0 || back_driving_ != 0) {
    const double rate = sliding_rate(motion);
    tau += driving_ * directional_efficiency(rate, load, EfficiencyColumn::driving) +
           back_driving_ * directional_efficiency(rate, load, EfficiencyColumn::back_driving);
  }
  return tau;
}

double FrictionLaw::transmitted(double tau, const JointMotion& motion) const {
  const double rest = tau - resistance(motion);
  if (driving_ == 0 && back_driving_ == 0) return rest;
  // The load has the sign of the rest, since neither share reaches 1 against it.
  return rest * motion.direction > 0 ? rest / (1 + driving_) : rest / (1 - back_driving_);
}

HysteresisShape<double> FrictionLaw::loop_shape() const {
  return loop_ ? HysteresisShape<double>{loop_->shape(0), loop_->shape(1)} : HysteresisShape<double>{};
}

double FrictionLaw::loop_rate(double rate, double state) const {
  return loop_ ? hysteresis_rate(rate, state, loop_shape()) : 0;
}

}  // namespace deltadyn
