#pragma once

/// \file
/// The joint with friction that is no drive: the slide of a telescope bar, or the joints inside an articulated plate.
/// All of the latter turn or slide in proportion to theta, so no motion tells their friction apart: they stand as one
/// joint with the coordinate theta, whose friction moment is the sum of theirs, each by its rate per theta.

#include "deltadyn/kinematics/motion.hpp"

namespace deltadyn {

template <class T, class Robot>
struct InnerJoint {
  T position, rate, acceleration;  ///< of the slide [m, m/s, m/s^2], of theta [rad, rad/s, rad/s^2]
  RowVector<T, Robot::kDrives> J;  ///< d rate / d qd
};

template <class T, class Robot>
InnerJoint<T, Robot> inner_joint(const Motion<T, Robot>& motion) {
  static_assert(kHasInnerJoint<Robot>, "this robot has none");
  const auto& posture = motion.posture;
  if constexpr (Robot::kTelescope) {
    return {posture.telescope.length, motion.telescope.length_d, motion.telescope.length_dd,
            posture.telescope.J_length};
  } else {
    const T& gain = posture.theta_gain;
    return {posture.theta, gain * motion.zd(3), gain * motion.zdd(3), gain * posture.J_plate.row(3)};
  }
}

}  // namespace deltadyn
