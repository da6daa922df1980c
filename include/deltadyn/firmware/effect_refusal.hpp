#pragma once

/// \file
/// Which effects a controller can feed forward, and why not the others.

#include "deltadyn/effects/visit.hpp"
#include "deltadyn/model/topology.hpp"

namespace deltadyn {

enum class EffectRefusal {
  none,
  of_the_record,  ///< what was recorded changes, not what the machine needs
  spring,         ///< a spring or play: asks for derivatives of the set point beyond the acceleration
  of_one_log,     ///< acts in one log only
  memory_elsewhere,
  not_in_list,  ///< the program was built without it
  no_such_place,
  bad_number,
  no_room,
};

/// One line in plain words, for messages.
constexpr const char* message(EffectRefusal refusal) {
  switch (refusal) {
    case EffectRefusal::none: return "it acts";
    case EffectRefusal::of_the_record: return "of the record, not of the machine";
    case EffectRefusal::spring: return "a spring or play: needs derivatives of the set point beyond the acceleration";
    case EffectRefusal::of_one_log: return "of one log only: set the payload at run time";
    case EffectRefusal::memory_elsewhere: return "has a memory, which the controller keeps for drives only";
    case EffectRefusal::not_in_list: return "not among the effects that the program was built with";
    case EffectRefusal::no_such_place: return "this robot has no such place";
    case EffectRefusal::bad_number: return "a number is not finite or outside its domain";
    case EffectRefusal::no_room: return "no room for another effect";
  }
  return "unknown";
}

namespace detail {

/// A Machine that only looks for springs.
struct SpringSeeker {
  bool spring = false;
  void tilt(double, double) {}
  void shift_home(int, double) {}
  void lengthen_arm(int, double) {}
  void lengthen_strut(int, double) {}
  void add_to_arm(int, double, double) {}
  void add_rotor(int, double) {}
  void add_to_plate(double) {}
  void soften(int, const SpringInDrive&) { spring = true; }
};

template <class Effect>
constexpr bool acts_in_one_log() {
  const EffectTraits traits = Effect::traits();
  for (const ShapeTraits& shape : traits.shapes) {
    if (shape.scale == ShapeScale::logs) return true;
  }
  return false;
}

constexpr bool is_on_drive(EffectPlace place) {
  return place == EffectPlace::drive || place == EffectPlace::arm || place == EffectPlace::limb ||
         place == EffectPlace::limb_or_all || place == EffectPlace::drive_or_robot;
}

}  // namespace detail

/// What keeps a controller from feeding an effect forward, whatever the robot; none if nothing does.
template <class Effect>
EffectRefusal refusal_of(const Shape<double>& shape) {
  if constexpr (kIs<Effect, RecordedChange>) return EffectRefusal::of_the_record;
  if constexpr (kIs<Effect, ElasticJoint>) return EffectRefusal::spring;
  if constexpr (detail::acts_in_one_log<Effect>()) return EffectRefusal::of_one_log;
  if constexpr (HasChange<Effect, detail::SpringSeeker>::value) {
    detail::SpringSeeker seeker;
    std::array<double, kMostAmplitudes> unit{};
    unit.fill(1.0);
    Effect::change(seeker, 0, unit, shape);
    if (seeker.spring) return EffectRefusal::spring;
  }
  if constexpr (kIs<Effect, JointMemory> && !detail::is_on_drive(Effect::traits().place))
    return EffectRefusal::memory_elsewhere;
  return EffectRefusal::none;
}

inline EffectRefusal refusal_of(EffectId id, const Shape<double>& shape) {
  EffectRefusal refusal = EffectRefusal::not_in_list;
  visit_effect(id, [&](auto effect) { refusal = refusal_of<decltype(effect)>(shape); });
  return refusal;
}

/// Can an effect with this place act at this joint?
/// \param joint  drive from 0; -1: not on one drive
template <class Robot>
constexpr bool has_place(EffectPlace place, int joint) {
  const bool on_drive = joint >= 0 && joint < Robot::kDrives;
  switch (place) {
    case EffectPlace::drive: return on_drive;
    case EffectPlace::arm:
      return on_drive && joint < Robot::kLimbs && kHasPlate<Robot> && Robot::kDrive == DriveKind::revolute;
    case EffectPlace::limb: return on_drive && joint < Robot::kLimbs && kHasPlate<Robot>;
    case EffectPlace::limb_or_all: return joint == -1 || (on_drive && (joint < Robot::kLimbs || !kHasPlate<Robot>));
    case EffectPlace::drive_or_robot: return on_drive || joint == -1;
    case EffectPlace::telescope: return joint == -1 && Robot::kTelescope;
    case EffectPlace::passive_joints:
    case EffectPlace::platform:
    case EffectPlace::robot: return joint == -1 && kHasPlate<Robot>;
  }
  return false;
}

/// Can it act anywhere on this robot?
template <class Robot>
constexpr bool has_any_place(EffectPlace place) {
  for (int joint = -1; joint < Robot::kDrives; ++joint) {
    if (has_place<Robot>(place, joint)) return true;
  }
  return false;
}

}  // namespace deltadyn
