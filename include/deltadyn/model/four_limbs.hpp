#pragma once

/// \file
/// What the robots with four limbs and an articulated plate have in common.

#include "deltadyn/model/plate_shape.hpp"

namespace deltadyn {

/// Limbs 1 and 2 hold half plate 1, limbs 3 and 4 half plate 2.
struct FourLimbs {
  static constexpr int kLimbs = 4;
  static constexpr int kDrives = 4;
  static constexpr bool kTelescope = false;
  static constexpr bool kPlateTurns = true;
  static constexpr DriveKind kDrive = DriveKind::revolute;

 protected:
  /// Part `to` is part `from` the other way round.
  template <int kParts>
  static void face(const PlateShape& shape, PlatePart<double> (&parts)[kParts], int from, int to) {
    constexpr double kHalfTurn = 3.14159265358979323846;
    parts[from].turn = shape.azimuth;
    parts[to].turn = shape.azimuth + kHalfTurn;
  }

  /// Halves 0 and 1 on hinges, whose origins are the hinges.
  template <int kParts>
  static void hinge_halves(const PlateShape& shape, PlatePart<double> (&parts)[kParts]) {
    const Vector3<double> hinge = 0.5 * shape.spacing * shape.outwards();
    parts[0].a = hinge;
    parts[1].a = -hinge;
    face(shape, parts, 0, 1);
  }
};

}  // namespace deltadyn
