#pragma once

/// \file
/// How far the catalogue's laws are from the machine's.

#include "deltadyn/runtime/effect_catalogue.hpp"

namespace deltadyn::detail {

/// What no residual tells. The shares are about twice what hidden effects leave that were made in other forms than the catalogue's.
struct FormShare {
  double amplitude;   ///< standard deviation of an amplitude, of its size: the column is not quite what the machine does
  double own, other;  ///< of the effect's gain, left at its place for effects that depend on the same, and for all others
};

[[nodiscard]] inline FormShare form_share(EffectId id) {
  switch (id) {
    case EffectId::asymmetric_coulomb:
    case EffectId::asymmetric_viscous:
      return {0.01, 0.12, 5e-4};  // linear, but friction that differs by direction does so in more ways
    case EffectId::rotor_inertia:
    case EffectId::limb_inertia_mismatch:
    case EffectId::payload:
    case EffectId::torque_constant_error: return {0.01, 5e-4, 5e-4};  // linear in what is known
    case EffectId::base_tilt: return {0.01, 3e-3, 3e-3};              // the first term of a series ...
    case EffectId::kinematic_offset:
    case EffectId::hose_force: return {0.03, 3e-3, 3e-3};
    case EffectId::current_lag:
    case EffectId::time_skew: return {0.03, 0.06, 0.06};
    case EffectId::joint_elasticity: return {0.15, 0.06, 0.06};  // ... that converges slowly
    case EffectId::load_dependent_friction:
    case EffectId::directional_efficiency: return {0.06, 0.12, 0.04};  // of the torque on one side of the gear or on the other
    case EffectId::presliding:
    case EffectId::hysteresis:
    case EffectId::backlash: return {0.03, 0.25, 0.06};
    default: return {0.03, 0.05, 0.02};
  }
}

}  // namespace deltadyn::detail
