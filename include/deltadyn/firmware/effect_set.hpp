#pragma once

/// \file
/// A few effects at their places on one robot, evaluated at one set point: fixed capacity, no heap, bounded time.

#include "deltadyn/core/smooth_sign.hpp"
#include "deltadyn/core/status.hpp"
#include "deltadyn/effects/side_load.hpp"
#include "deltadyn/effects/some_effects.hpp"
#include "deltadyn/firmware/changed_geometry.hpp"
#include "deltadyn/firmware/effect_term.hpp"
#include "deltadyn/kinematics/passive_joints.hpp"
#include "deltadyn/kinematics/tool_point.hpp"

namespace deltadyn {

/// One set point as effects see it.
template <class T, class Robot>
struct EffectScene {
  /// Place of the passive joints in `width`, behind drives and inner joint
  static constexpr int kPassive = Robot::kDrives + 1;
  using Drives = Vector<T, Robot::kDrives>;

  const Motion<T, Robot>& motion;      ///< of the machine as it is
  const Geometry<T, Robot>& geometry;  ///< of the machine as it is
  const Drives& q;                     ///< as the encoders have it [rad | m]
  /// Rigid torque without the drives' own friction, rotor inertia and offset [N m | N]
  const Drives& load;
  const Vector<T, kPassive + 1>& width;  ///< of a reversal: drives, inner joint, passive joints [rad/s | m/s]
  T time;                                ///< [s]

  [[nodiscard]] JointInput<T> at_drive(int drive) const {
    JointInput<T> in = at_rate(motion.qd(drive), drive);
    in.position = q(drive);
    in.acceleration = motion.qdd(drive);
    in.load = load(drive);
    if (drive < Robot::kLimbs) {
      const Matrix3<T>& R_WL = motion.posture.limbs[drive].R_WL;
      in.gravity_x = R_WL.col(0).dot(geometry.gravity);
      in.gravity_z = R_WL.col(2).dot(geometry.gravity);
    }
    return in;
  }
  [[nodiscard]] JointInput<T> at_telescope() const {
    JointInput<T> in = at_rate(motion.telescope.length_d, Robot::kDrives);
    in.side_load = side_load<T>(motion.posture.telescope.e, motion.zdd.template head<3>(), geometry.gravity);
    return in;
  }
  [[nodiscard]] PlateInput<T> at_plate() const {
    PlateInput<T> in;
    const auto tool = tool_point(geometry, motion);
    in.position = tool.position;
    in.velocity = tool.velocity;
    in.acceleration = tool.acceleration;
    in.gravity = geometry.gravity;
    return in;
  }
  [[nodiscard]] JointInput<T> at_rate(const T& rate, int joint) const {
    JointInput<T> in;
    in.rate = rate;
    in.sign = smooth_sign(rate, width(joint));
    in.time = time;
    return in;
  }
};

/// \tparam kCapacity  most effects
/// \tparam List       EffectList of those that may be added; a program holds no code of the others
template <class T, class Robot, int kCapacity, class List = AllEffects>
class EffectSet {
 public:
  using Drives = Vector<T, Robot::kDrives>;

  /// What the laws remember.
  struct Memory {
    bool started = false;
    Drives q = Drives::Zero();  ///< of the last set point [rad | m]
    T state[kCapacity > 0 ? kCapacity : 1] = {};
  };

  /// Adds an effect; one that changes the machine changes it here and now. On a refusal all stays as it was.
  EffectRefusal add(const EffectRow& row, ChangedGeometry<T, Robot>& machine) {
    EffectRefusal refusal = EffectRefusal::not_in_list;
    visit_effect_in<List>(row.id, [&](auto effect) { refusal = add_as<decltype(effect)>(row, machine); });
    return refusal;
  }

  /// Memory of drives that have slid long with these rates; a drive at rest remembers nothing.
  [[nodiscard]] Memory start(const Drives& q, const Drives& qd) const {
    Memory memory;
    memory.started = true;
    memory.q = q;
    for (int k = 0; k < count_; ++k) {
      const Term& term = terms_[k];
      visit_effect_in<List>(term.id, [&](auto effect) {
        using E = decltype(effect);
        if constexpr (kIs<E, JointMemory>) memory.state[k] = E::start(sign_of(qd(term.joint)), term.shape);
      });
    }
    return memory;
  }

  /// Moves the memory to the set point and adds the torque [N m | N] of all effects there.
  void add_torque(const EffectScene<T, Robot>& scene, Memory& memory, Drives& tau) const {
    if (!memory.started) memory = start(scene.q, scene.motion.qd);
    for (int k = 0; k < count_; ++k) {
      visit_effect_in<List>(terms_[k].id, [&](auto effect) {
        add_torque_of<decltype(effect)>(terms_[k], scene, memory.q, memory.state[k], tau);
      });
    }
    memory.q = scene.q;
  }

  /// Scales the effects of this role at a drive, beside their sizes as they were added.
  void scale(Role role, int drive, const T& gain) {
    for (int k = 0; k < count_; ++k) {
      if (terms_[k].role == role && terms_[k].joint == drive) terms_[k].gain = gain;
    }
  }

  [[nodiscard]] int count() const { return count_; }

 private:
  using Term = EffectTerm<T>;

  template <class E>
  EffectRefusal add_as(const EffectRow& row, ChangedGeometry<T, Robot>& machine) {
    Term term;
    const EffectRefusal refusal = make_term<E>(row, term);
    if (refusal != EffectRefusal::none) return refusal;
    if (!has_place<Robot>(E::traits().place, row.joint)) return EffectRefusal::no_such_place;
    if (kIs<E, JointMemory> && row.joint < 0) return EffectRefusal::memory_elsewhere;
    if (count_ >= kCapacity) return EffectRefusal::no_room;
    if constexpr (kIs<E, MachineChange> && has_any_place<Robot>(E::traits().place)) {
      ChangedGeometry<T, Robot> changed = machine;
      E::change(changed, row.joint, row.amplitude, row.shape);
      if (!changed.complete) return EffectRefusal::spring;
      machine = changed;
    }
    terms_[count_++] = term;
    return EffectRefusal::none;
  }

  template <class E>
  static T sum(const ColumnsOf<T, E>& columns, const Term& term) {
    T total = T(0);
    for (std::size_t c = 0; c < columns.size(); ++c) total += term.amplitude[c] * columns[c];
    return term.gain * total;
  }

  template <class E>
  static void add_torque_of(const Term& term, const EffectScene<T, Robot>& scene, const Drives& q_before, T& state,
                            Drives& tau) {
    constexpr EffectPlace place = E::traits().place;
    if constexpr (kIs<E, JointMemory> && detail::is_on_drive(place)) {
      const JointInput<T> in = scene.at_drive(term.joint);
      state = E::moved(state, T(in.position - q_before(term.joint)), in, term.shape);
      tau(term.joint) += sum<E>(E::columns(state, in, term.shape), term);
    } else if constexpr (kIs<E, JointLaw> && detail::is_on_drive(place)) {
      // Joint -1: all drives alike, of limbs where the robot has limbs.
      constexpr int kAlike = place == EffectPlace::limb_or_all && kHasPlate<Robot> ? Robot::kLimbs : Robot::kDrives;
      const int first = term.joint >= 0 ? term.joint : 0, end = term.joint >= 0 ? term.joint + 1 : kAlike;
      for (int j = first; j < end; ++j) tau(j) += sum<E>(E::columns(scene.at_drive(j), term.shape), term);
    } else if constexpr (kIs<E, JointLaw> && place == EffectPlace::telescope && Robot::kTelescope) {
      tau += sum<E>(E::columns(scene.at_telescope(), term.shape), term) *
             scene.motion.posture.telescope.J_length.transpose();
    } else if constexpr (kIs<E, JointLaw> && place == EffectPlace::passive_joints) {
      for_each_passive_joint(scene.motion, [&](int index, const PassiveJoint<T, Robot>& joint) {
        JointInput<T> in = scene.at_rate(joint.rate, EffectScene<T, Robot>::kPassive);
        in.acceleration = joint.acceleration;
        tau += (T(passive_joints_alike<Robot>(index)) * sum<E>(E::columns(in, term.shape), term)) * joint.J.transpose();
      });
    } else if constexpr (kIs<E, PlateForce> && kHasPlate<Robot>) {
      const auto forces = E::columns(scene.at_plate(), term.shape);
      Vector3<T> force = Vector3<T>::Zero();
      for (std::size_t c = 0; c < forces.size(); ++c) force += term.amplitude[c] * forces[c];
      tau += tool_point(scene.geometry, scene.motion).J.transpose().lazyProduct(force);
    }
  }

  Term terms_[kCapacity > 0 ? kCapacity : 1];
  int count_ = 0;
};

}  // namespace deltadyn
