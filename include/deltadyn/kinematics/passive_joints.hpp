#pragma once

/// \file
/// The ball and universal joints as revolute joints (paper II.A): what the friction of joints without drives needs.

#include "deltadyn/kinematics/motion.hpp"

namespace deltadyn {

/// Different passive joints of a robot: three a limb, and two of a telescope.
template <class Robot>
inline constexpr int kPassiveJoints = (kHasPlate<Robot> ? 3 * Robot::kLimbs : 0) + (Robot::kTelescope ? 2 : 0);

/// Equal joints of the robot that one of them stands for: both ends of the two struts of each limb have the turn about
/// the strut's own z.
template <class Robot>
constexpr int passive_joints_alike(int index) {
  return index < 3 * Robot::kLimbs && index % 3 == 2 ? 4 : 2;
}

/// One of them.
template <class T, class Robot>
struct PassiveJoint {
  T rate, acceleration;            ///< [rad/s], [rad/s^2]
  RowVector<T, Robot::kDrives> J;  ///< d rate / d qd
};

/// Calls function(index, joint) for each: of each limb the elbow (where beta turns against the arm, whose own rotation
/// is the drive's), the strut's other end, and the turn gamma of both; then the two universal joints of a telescope
/// bar.
template <class T, class Robot, class Function>
void for_each_passive_joint(const Motion<T, Robot>& motion, Function function) {
  using Joint = PassiveJoint<T, Robot>;
  int index = 0;
  if constexpr (kHasPlate<Robot>) {
    for (int i = 0; i < Robot::kLimbs; ++i) {
      const auto& posture = motion.posture.limbs[i];
      const auto& limb = motion.limbs[i];
      Joint elbow{limb.beta_d, limb.beta_dd, posture.J_beta};
      if constexpr (Robot::kDrive == DriveKind::revolute) {
        elbow.J(i) -= T(1);
        elbow.rate -= motion.qd(i);
        elbow.acceleration -= motion.qdd(i);
      }
      function(index++, elbow);
      function(index++, Joint{limb.beta_d, limb.beta_dd, posture.J_beta});
      function(index++, Joint{limb.gamma_d, limb.gamma_dd, posture.J_gamma});
    }
    if constexpr (Robot::kTelescope) {
      const auto& bar = motion.telescope;
      function(index++, Joint{bar.a_d, bar.a_dd, motion.posture.telescope.J_a});
      function(index++, Joint{bar.b_d, bar.b_dd, motion.posture.telescope.J_b});
    }
  }
}

}  // namespace deltadyn
