#pragma once

/// \file
/// LinkPoses of one compile-time type.

#include <cmath>

#include "deltadyn/kinematics/posture.hpp"
#include "deltadyn/runtime/link_poses.hpp"

namespace deltadyn::detail {

template <class R>
LinkPoses link_poses_of(const Geometry<double, R>& geometry, const Posture<double, R>& posture) {
  const auto radians = [](const SinCos<double>& angle) { return std::atan2(angle.sin, angle.cos); };
  LinkPoses out;
  if constexpr (kHasPlate<R>) out.plate = posture.z.template head<3>();
  for (int i = 0; i < R::kLimbs; ++i) {
    const auto& limb = posture.limbs[i];
    LinkPoses::Limb one;
    one.R_WL = limb.R_WL;
    one.elbow = geometry.limbs[i].p_WD + limb.R_WL * limb.p_DE.value;
    if constexpr (kHasPlate<R>) {
      one.plate = out.plate + limb.R_WL * limb.p_BA.value;
      one.strut = limb.R_WL * limb.u;
    }
    one.beta = radians(limb.beta);
    one.gamma = radians(limb.gamma);
    out.limbs.push_back(one);
  }
  if constexpr (R::kPlateTurns) {
    for (const auto& part : geometry.parts) {
      const PartPose<double> pose = part_pose(part, posture.z(3), geometry.yaw_ratio);
      out.parts.push_back({out.plate + pose.p.value, radians(pose.angle)});
    }
  }
  if constexpr (R::kTelescope)
    out.telescope = {radians(posture.telescope.a), radians(posture.telescope.b), posture.telescope.length};
  return out;
}

}  // namespace deltadyn::detail
