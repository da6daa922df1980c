#pragma once

/// \file
/// The list of all effects, in the order in which they are shown. A new effect is its header and a line here.

#include "deltadyn/effects/aerodynamic_drag.hpp"
#include "deltadyn/effects/arm_spring.hpp"
#include "deltadyn/effects/asymmetric_coulomb.hpp"
#include "deltadyn/effects/asymmetric_viscous.hpp"
#include "deltadyn/effects/backlash.hpp"
#include "deltadyn/effects/base_tilt.hpp"
#include "deltadyn/effects/convex_viscous.hpp"
#include "deltadyn/effects/current_lag.hpp"
#include "deltadyn/effects/direction_dependent_friction.hpp"
#include "deltadyn/effects/directional_efficiency.hpp"
#include "deltadyn/effects/hose_force.hpp"
#include "deltadyn/effects/hysteresis.hpp"
#include "deltadyn/effects/joint_elasticity.hpp"
#include "deltadyn/effects/kinematic_offset.hpp"
#include "deltadyn/effects/limb_inertia_mismatch.hpp"
#include "deltadyn/effects/load_dependent_friction.hpp"
#include "deltadyn/effects/passive_joint_friction.hpp"
#include "deltadyn/effects/payload.hpp"
#include "deltadyn/effects/position_dependent_friction.hpp"
#include "deltadyn/effects/presliding.hpp"
#include "deltadyn/effects/rotor_inertia.hpp"
#include "deltadyn/effects/saturation.hpp"
#include "deltadyn/effects/shear_thinning.hpp"
#include "deltadyn/effects/stribeck.hpp"
#include "deltadyn/effects/telescope_side_load.hpp"
#include "deltadyn/effects/telescope_stribeck.hpp"
#include "deltadyn/effects/thermal_drift.hpp"
#include "deltadyn/effects/time_skew.hpp"
#include "deltadyn/effects/torque_constant_error.hpp"
#include "deltadyn/effects/torque_ripple.hpp"

namespace deltadyn {

template <class... Effects>
struct EffectList {
  static constexpr int kCount = sizeof...(Effects);
};

using AllEffects =
    EffectList<effects::Stribeck, effects::ShearThinning, effects::ConvexViscous, effects::AsymmetricCoulomb,
               effects::AsymmetricViscous, effects::LoadDependentFriction, effects::DirectionalEfficiency,
               effects::Presliding, effects::Hysteresis, effects::TorqueRipple, effects::PositionDependentFriction,
               effects::Backlash, effects::JointElasticity, effects::RotorInertia, effects::LimbInertiaMismatch,
               effects::BaseTilt, effects::Payload, effects::TorqueConstantError, effects::TimeSkew,
               effects::CurrentLag, effects::Saturation, effects::ThermalDrift, effects::PassiveJointFriction,
               effects::AerodynamicDrag, effects::TelescopeStribeck, effects::TelescopeSideLoad, effects::HoseForce,
               effects::KinematicOffset, effects::DirectionDependentFriction, effects::ArmSpring>;

}  // namespace deltadyn
