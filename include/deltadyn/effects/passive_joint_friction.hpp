#pragma once

#include "deltadyn/core/types.hpp"
#include "deltadyn/effects/coulomb_friction.hpp"
#include "deltadyn/kinematics/motion.hpp"

namespace deltadyn {

/// Coulomb friction of the ball and universal joints: power mu sum |w| over the joints' two angles each, so that the drives bear
/// mu sum d|w|/dqd = mu sum sign(w) dw/dqd. Both ends of the two struts of each limb count (four times beta and gamma), then the two
/// universal joints of a telescope bar. Amplitude mu [N m] > 0, the same for every joint.
/// Valid for preload that does not change with the pose. Source: paper II.A (balls as two revolute joints), Coulomb's law in each.
template <class T, class Robot>
Vector<T, Robot::kDrives> passive_joint_friction(const Motion<T, Robot>& motion) {
  Vector<T, Robot::kDrives> torque = Vector<T, Robot::kDrives>::Zero();
  if constexpr (kHasPlate<Robot>) {
    for (int i = 0; i < Robot::kLimbs; ++i) {
      const auto& posture = motion.posture.limbs[i];
      // The base end turns against the arm, whose own rotation is the drive's.
      RowVector<T, Robot::kDrives> J_elbow = posture.J_beta;
      T elbow_rate = motion.limbs[i].beta_d;
      if constexpr (Robot::kDrive == DriveKind::revolute) {
        J_elbow(i) -= T(1);
        elbow_rate -= motion.qd(i);
      }
      torque += T(2) * coulomb_friction(elbow_rate) * J_elbow.transpose();
      torque += T(2) * coulomb_friction(motion.limbs[i].beta_d) * posture.J_beta.transpose();
      torque += T(4) * coulomb_friction(motion.limbs[i].gamma_d) * posture.J_gamma.transpose();
    }
    if constexpr (Robot::kTelescope) {
      torque += T(2) * coulomb_friction(motion.telescope.a_d) * motion.posture.telescope.J_a.transpose();
      torque += T(2) * coulomb_friction(motion.telescope.b_d) * motion.posture.telescope.J_b.transpose();
    }
  }
  return torque;
}

}  // namespace deltadyn
