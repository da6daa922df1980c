#pragma once

/// \file
/// Forward kinematics along a path, for one compile-time type.

#include "deltadyn/kinematics/motion.hpp"
#include "deltadyn/runtime/path_pose.hpp"

namespace deltadyn::detail {

/// Task coordinates of the drives, from the row before if `path` knows it; keeps them there.
template <class R>
Status pose_along(const Geometry<double, R>& geometry, const Vector<double, R::kDrives>& q, PathPose* path,
                  Vector<double, R::kDrives>& z) {
  if constexpr (R::kPlateTurns) {
    if (path != nullptr) {
      const Status status =
          path->known ? forward_kinematics_from<double, R>(geometry, q, Vector<double, R::kDrives>(path->z), z)
                      : forward_kinematics(geometry, q, z);
      path->known = status == Status::ok;
      if (path->known) path->z = z;
      return status;
    }
  }
  return forward_kinematics(geometry, q, z);
}

template <class R>
Status posture_along(const Geometry<double, R>& geometry, const Vector<double, R::kDrives>& q, PathPose* path,
                     Posture<double, R>& posture) {
  Vector<double, R::kDrives> z;
  const Status status = pose_along(geometry, q, path, z);
  return status == Status::ok ? assemble_posture(geometry, q, z, posture) : status;
}

/// motion_from_drives() along a path.
template <class R>
Status motion_along(const Geometry<double, R>& geometry, const Vector<double, R::kDrives>& q,
                    const Vector<double, R::kDrives>& qd, const Vector<double, R::kDrives>& qdd, PathPose* path,
                    Motion<double, R>& motion) {
  if (!qd.allFinite() || !qdd.allFinite()) return Status::out_of_range;
  const Status status = posture_along(geometry, q, path, motion.posture);
  if (status == Status::ok) set_drive_rates(geometry, qd, qdd, motion);
  return status;
}

}  // namespace deltadyn::detail
