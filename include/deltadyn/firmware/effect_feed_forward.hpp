#pragma once

/// \file
/// Feed-forward with the effects that a rigid model misses. firmware/feed_forward.hpp is the leaner one without.

#include "deltadyn/dynamics/inverse_dynamics.hpp"
#include "deltadyn/firmware/effect_set.hpp"
#include "deltadyn/firmware/live_parameters.hpp"

namespace deltadyn {

/// Model-based feed-forward of one robot with up to kCapacity effects: drive torques of the wanted motion, with no
/// heap, no exceptions and a bounded time. Keep one object for the life of the controller: laws with memory follow its
/// set points one after the other.
/// \tparam T     float or double
/// \tparam List  EffectList of the effects that may be added; a program holds no code of the others
template <class T, class Robot, Limbs kSharing, int kCapacity, class List = AllEffects>
class EffectFeedForward {
 public:
  using Layout = ParameterLayout<Robot, kSharing>;
  using Drives = Vector<T, Robot::kDrives>;
  using Parameters = Vector<T, Layout::kColumns>;
  using Scene = EffectScene<T, Robot>;

  static constexpr int kInnerJoint = Robot::kDrives;      ///< behind the drives, in set_friction and set_reversal_width
  static constexpr int kPassiveJoints = Scene::kPassive;  ///< in set_reversal_width: all ball and universal joints

  EffectFeedForward(const Geometry<T, Robot>& geometry, const Parameters& p) : machine_(geometry), p_(p), given_(p) {}

  /// With the effects of a table, as a converted header holds it; effects() tells how many of them act.
  template <std::size_t kRows>
  EffectFeedForward(const Geometry<T, Robot>& geometry, const Parameters& p, const EffectRow (&rows)[kRows])
      : EffectFeedForward(geometry, p) {
    for (const EffectRow& row : rows) static_cast<void>(add(row));
  }

  /// Adds an effect, before the loop begins. What cannot act is refused with a reason and changes nothing.
  [[nodiscard]] EffectRefusal add(const EffectRow& row) { return effects_.add(row, machine_); }

  [[nodiscard]] int effects() const { return effects_.count(); }

  /// Width of a reversal: Coulomb's friction and all laws that turn with the sign of a rate take rate / sqrt(rate^2 +
  /// width^2) for it, so that a set point which stops takes no jump of the torque. 0, the value at first: the sign
  /// itself.
  /// \param joint  drive from 0, kInnerJoint or kPassiveJoints
  /// \param width  at least 0 [rad/s | m/s]
  /// \return out_of_range for another joint or width; then all stays as it was
  Status set_reversal_width(int joint, const T& width) {
    if (joint < 0 || joint > kPassiveJoints || !(width >= T(0)) || !(width - width == T(0)))
      return Status::out_of_range;
    width_(joint) = width;
    return Status::ok;
  }

  /// Seconds since start, for the laws that depend on it; 0 at first. \return out_of_range if not finite: the last one
  /// stays
  Status set_time(const T& seconds) {
    if (!(seconds - seconds == T(0))) return Status::out_of_range;
    time_ = seconds;
    return Status::ok;
  }

  /// As LiveParameters::set_payload.
  Status set_payload(const T& mass, const Vector3<T>& position, const Matrix3<T>& inertia = Matrix3<T>::Zero()) {
    return p_.set_payload(mass, position, inertia);
  }

  /// As LiveParameters::set_friction. Bristles of the joint, which are its Coulomb friction near a reversal, follow in
  /// proportion; all other effects stay as they are.
  Status set_friction(int joint, const T& viscous, const T& coulomb) {
    const Status status = p_.set_friction(joint, viscous, coulomb);
    if (status != Status::ok) return status;
    const T first = given_(Layout::coulomb(joint));
    if (first > T(0)) effects_.scale(Role::bristle, joint, coulomb / first);
    return status;
  }

  /// Starts the memories anew, as of drives that have slid long with the rates qd (a drive at rest remembers nothing).
  /// Without this call they start so at the first set point. \return out_of_range if a number is not finite; then all
  /// stays as it was
  Status reset(const Drives& q, const Drives& qd) {
    if (!q.allFinite() || !qd.allFinite()) return Status::out_of_range;
    memory_ = effects_.start(q, qd);
    return Status::ok;
  }

  /// Torques [N m | N] for a task-space set point (z, zd, zdd), and the drive set point that belongs to it, as the
  /// encoders have it. On any status but ok, q, qd, tau and the memories keep their values, so that a loop may go on
  /// with the last good ones.
  Status from_task(const Drives& z, const Drives& zd, const Drives& zdd, Drives& q, Drives& qd, Drives& tau) {
    Motion<T, Robot> motion;
    Status status = motion_from_task(machine_.geometry, z, zd, zdd, motion);
    if (status != Status::ok) return status;
    const Drives encoder = motion.posture.q - machine_.home_offset;
    status = torque(motion, encoder, tau);
    if (status != Status::ok) return status;
    q = encoder;
    qd = motion.qd;
    return status;
  }

  /// Torques for a drive set point (q, qd, qdd), q as the encoders have it. On any status but ok, tau and the memories
  /// stay.
  Status from_drives(const Drives& q, const Drives& qd, const Drives& qdd, Drives& tau) {
    Motion<T, Robot> motion;
    const Drives actual = q + machine_.home_offset;
    const Status status = motion_from_drives(machine_.geometry, actual, qd, qdd, motion);
    if (status != Status::ok) return status;
    return torque(motion, q, tau);
  }

 private:
  Status torque(const Motion<T, Robot>& motion, const Drives& q, Drives& tau) {
    Drives load = Drives::Zero();
    if constexpr (kHasInnerJoint<Robot>) {
      const InnerJoint<T, Robot> inner = inner_joint(motion);
      load = friction(kInnerJoint, inner.rate) * inner.J.transpose();
    }
    add_torque_of_bodies<Layout>(machine_.geometry, motion, p_(), load);
    Drives total = load;
    for (int drive = 0; drive < Robot::kDrives; ++drive) {
      total(drive) += friction(drive, motion.qd(drive)) + p_()(Layout::kRotorInertia + drive) * motion.qdd(drive) +
                      p_()(Layout::kOffset + drive);
    }
    auto memory = memory_;
    effects_.add_torque(Scene{motion, machine_.geometry, q, load, width_, time_}, memory, total);
    if (!total.allFinite()) return Status::out_of_range;
    memory_ = memory;
    tau = total;
    return Status::ok;
  }

  [[nodiscard]] T friction(int joint, const T& rate) const {
    return p_()(Layout::viscous(joint)) * rate + p_()(Layout::coulomb(joint)) * smooth_sign(rate, width_(joint));
  }

  ChangedGeometry<T, Robot> machine_;
  LiveParameters<T, Robot, kSharing> p_;
  Parameters given_;
  EffectSet<T, Robot, kCapacity, List> effects_;
  typename EffectSet<T, Robot, kCapacity, List>::Memory memory_;
  Vector<T, kPassiveJoints + 1> width_ = Vector<T, kPassiveJoints + 1>::Zero();
  T time_ = T(0);
};

}  // namespace deltadyn
