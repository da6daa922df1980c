#pragma once

/// \file
/// A robot's geometry in another scalar.

#include "deltadyn/model/geometry.hpp"

namespace deltadyn {

/// All lengths and places of `from` as numbers of type To, e.g. from double to float.
template <class To, class From, class Robot>
Geometry<To, Robot> cast_geometry(const Geometry<From, Robot>& from) {
  Geometry<To, Robot> to;
  for (int i = 0; i < Robot::kLimbs; ++i) {
    const LimbGeometry<From>& limb = from.limbs[i];
    to.limbs[i] = {To(limb.azimuth),
                   To(limb.tilt),
                   limb.p_WD.template cast<To>(),
                   limb.axis_L.template cast<To>(),
                   limb.p_DE_0.template cast<To>(),
                   To(limb.strut),
                   To(limb.strut_spacing),
                   limb.p_BA.template cast<To>(),
                   limb.part,
                   To(limb.elbow)};
  }
  for (int k = 0; k < Robot::kPlateParts; ++k) {
    const PlatePart<From>& part = from.parts[k];
    to.parts[k] = {part.c.template cast<To>(), part.a.template cast<To>(), part.b.template cast<To>(), To(part.kappa),
                   To(part.turn)};
  }
  to.yaw_ratio = To(from.yaw_ratio);
  to.theta_range = To(from.theta_range);
  to.mode = To(from.mode);
  to.telescope.p_WU = from.telescope.p_WU.template cast<To>();
  to.telescope.p_BV = from.telescope.p_BV.template cast<To>();
  to.gravity = from.gravity.template cast<To>();
  return to;
}

}  // namespace deltadyn
