#pragma once

/// \file
/// The Machine of effects/kinds.hpp without heap: a geometry and the encoders' zeros, with the changes that effects
/// make of them.

#include "deltadyn/core/rotation.hpp"
#include "deltadyn/effects/kinds.hpp"
#include "deltadyn/model/geometry.hpp"

namespace deltadyn {

/// What a controller can take of a change: gravity, lengths and zeros. Of inertias it takes none, because the effects
/// that change them have laws; of springs none, because they ask for derivatives of the acceleration.
template <class T, class Robot>
struct ChangedGeometry {
  Geometry<T, Robot> geometry;
  /// True drive coordinate minus the encoder's [rad | m]
  Vector<T, Robot::kDrives> home_offset = Vector<T, Robot::kDrives>::Zero();
  bool complete = true;  ///< false: a change was asked for that this machine cannot show

  explicit ChangedGeometry(const Geometry<T, Robot>& given) : geometry(given) {}

  void tilt(double x, double y) {
    const Vector3<T> turn(static_cast<T>(x), static_cast<T>(y), T(0));
    geometry.gravity += turn.cross(geometry.gravity).eval();
  }
  void shift_home(int drive, double by) { home_offset(drive) += static_cast<T>(by); }
  /// A carriage has no arm: an error of its place along the axis, which a length would be, is one of its home position.
  void lengthen_arm(int limb, double by) {
    if constexpr (Robot::kDrive == DriveKind::revolute) {
      geometry.limbs[limb].p_DE_0.x() += static_cast<T>(by);
    } else {
      shift_home(limb, by);
    }
  }
  void lengthen_strut(int limb, double by) { geometry.limbs[limb].strut += static_cast<T>(by); }
  void add_to_arm(int, double, double) { complete = false; }
  void add_rotor(int, double) { complete = false; }
  void add_to_plate(double) { complete = false; }
  void soften(int, const SpringInDrive&) { complete = false; }
};

}  // namespace deltadyn
