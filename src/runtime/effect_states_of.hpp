#pragma once

/// \file
/// EffectStates of one compile-time type.

#include "deltadyn/kinematics/inner_joint.hpp"
#include "deltadyn/kinematics/passive_joints.hpp"
#include "deltadyn/kinematics/tool_point.hpp"
#include "deltadyn/runtime/effect_states.hpp"
#include "deltadyn/runtime/geometry_of.hpp"

#include "posture_along.hpp"

namespace deltadyn::detail {

template <class R>
class EffectStatesOf final : public EffectStates {
 public:
  using Drives = Vector<double, R::kDrives>;
  explicit EffectStatesOf(const RobotDescription& description) : geometry_(geometry_of<double, R>(description)) {}

  Status at(const ConstRef& q, const ConstRef& qd, const ConstRef& qdd, EffectState& state,
            PathPose* path) const override {
    Motion<double, R> motion;
    const Status status = motion_along(geometry_, Drives(q), Drives(qd), Drives(qdd), path, motion);
    if (status != Status::ok) return status;
    state.J_inner.setZero(R::kDrives);
    const auto tool = tool_point(geometry_, motion);
    state.position = tool.position;
    state.velocity = tool.velocity;
    state.acceleration = tool.acceleration;
    state.J = tool.J;
    if constexpr (kHasInnerJoint<R>) {
      const InnerJoint<double, R> inner = inner_joint(motion);
      state.inner_rate = inner.rate;
      state.J_inner = inner.J;
    }
    if constexpr (R::kTelescope) state.bar = motion.posture.telescope.e;
    state.passive_rate.resize(kPassiveJoints<R>);
    state.J_passive.resize(kPassiveJoints<R>, R::kDrives);
    for_each_passive_joint(motion, [&state](int index, const PassiveJoint<double, R>& joint) {
      state.passive_rate(index) = joint.rate;
      state.J_passive.row(index) = passive_joints_alike<R>(index) * joint.J;
    });
    return status;
  }

 private:
  Geometry<double, R> geometry_;
};

template <class R>
std::unique_ptr<EffectStates> make_effect_states_of(const RobotDescription& description) {
  return std::make_unique<EffectStatesOf<R>>(description);
}

}  // namespace deltadyn::detail
