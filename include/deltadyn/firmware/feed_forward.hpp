#pragma once

/// \file
/// What a control loop needs: drive torques of the wanted motion, with no heap, no exceptions and a bounded time.

#include "deltadyn/dynamics/inverse_dynamics.hpp"
#include "deltadyn/firmware/live_parameters.hpp"

namespace deltadyn {

/// Model-based feed-forward of one robot; firmware/effect_feed_forward.hpp is the one with more friction laws and other
/// effects. Keep one object for the life of the controller.
/// \tparam T float or double
template <class T, class Robot, Limbs kSharing = Limbs::shared>
class FeedForward {
 public:
  using Layout = ParameterLayout<Robot, kSharing>;
  using Drives = Vector<T, Robot::kDrives>;
  using Parameters = Vector<T, Layout::kColumns>;

  FeedForward(const Geometry<T, Robot>& geometry, const Parameters& p) : geometry_(geometry), p_(p) {}

  /// As LiveParameters::set_payload.
  Status set_payload(const T& mass, const Vector3<T>& position, const Matrix3<T>& inertia = Matrix3<T>::Zero()) {
    return p_.set_payload(mass, position, inertia);
  }
  /// As LiveParameters::set_friction.
  Status set_friction(int joint, const T& viscous, const T& coulomb) {
    return p_.set_friction(joint, viscous, coulomb);
  }

  /// Torques [N m | N] for a task-space set point (z, zd, zdd), and the drive set point that belongs to it.
  /// On any status but ok, q, qd and tau keep their values, so that a loop may go on with the last good ones.
  Status from_task(const Drives& z, const Drives& zd, const Drives& zdd, Drives& q, Drives& qd, Drives& tau) const {
    Motion<T, Robot> motion;
    const Status status = motion_from_task(geometry_, z, zd, zdd, motion);
    if (status != Status::ok) return status;
    q = motion.posture.q;
    qd = motion.qd;
    tau = inverse_dynamics<Layout>(geometry_, motion, p_());
    return status;
  }

  /// Torques for a drive set point (q, qd, qdd).
  Status from_drives(const Drives& q, const Drives& qd, const Drives& qdd, Drives& tau) const {
    Motion<T, Robot> motion;
    const Status status = motion_from_drives(geometry_, q, qd, qdd, motion);
    if (status != Status::ok) return status;
    tau = inverse_dynamics<Layout>(geometry_, motion, p_());
    return status;
  }

 private:
  Geometry<T, Robot> geometry_;
  LiveParameters<T, Robot, kSharing> p_;
};

}  // namespace deltadyn
