#pragma once

/// \file
/// The point that carries the load: the tool's origin on an articulated plate, the plate's centre on a rigid one.

#include "deltadyn/kinematics/motion.hpp"

namespace deltadyn {

/// A point of the machine that moves; in W.
template <class T, int N>
struct PointMotion {
  Vector3<T> position = Vector3<T>::Zero();      ///< [m]
  Vector3<T> velocity = Vector3<T>::Zero();      ///< [m/s]
  Vector3<T> acceleration = Vector3<T>::Zero();  ///< [m/s^2]
  Matrix<T, 3, N> J = Matrix<T, 3, N>::Zero();   ///< d position / dq
};

/// Zero for a robot without a plate.
template <class T, class Robot>
PointMotion<T, Robot::kDrives> tool_point(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion) {
  PointMotion<T, Robot::kDrives> point;
  if constexpr (kHasPlate<Robot>) {
    point.position = motion.posture.z.template head<3>();
    point.velocity = motion.zd.template head<3>();
    point.acceleration = motion.zdd.template head<3>();
    point.J = motion.posture.J_plate.template topRows<3>();
  }
  if constexpr (Robot::kPlateTurns) {
    const PartPose<T> tool = part_pose(geometry.parts[tool_part<Robot>()], motion.posture.z(3), geometry.yaw_ratio);
    point.position += tool.p.value;
    point.velocity += tool.p.first * motion.zd(3);
    point.acceleration += tool.p.first * motion.zdd(3) + tool.p.second * (motion.zd(3) * motion.zd(3));
    point.J += tool.p.first * motion.posture.J_plate.row(3);
  } else {
    (void)geometry;
  }
  return point;
}

}  // namespace deltadyn
