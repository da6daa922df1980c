#pragma once

/// \file
/// Four limbs and a plate of two halves that slide on each other (Krut et al. 2003): limbs 1 and 2 hold one, 3 and 4
/// the other, and racks on both turn a pinion with the tool.

#include "deltadyn/model/four_limbs.hpp"

namespace deltadyn {

struct I4 : FourLimbs {
  static constexpr const char* kName = "i4";
  static constexpr const char* kClass = "I4";
  static constexpr int kPlateParts = 3;
  static constexpr Body kParts[] = {Body::half_plate, Body::half_plate, Body::tool};

  static PlateShape usual() {
    PlateShape shape;
    shape.pinion_radius = kNeeded;
    shape.range = 2.5;
    return shape;
  }
  static constexpr bool kGeared = false;
  static constexpr bool kToolOnAHalf = false;

  static void place_parts(const PlateShape& shape, PlatePart<double> (&parts)[kPlateParts]) {
    for (PlatePart<double>& part : parts) part = {};
    // The rack of half 1 touches the pinion on the side of half 1.
    const Vector3<double> travel = shape.pinion_radius * cross_z<double>(shape.outwards());
    parts[0].b = travel;
    parts[1].b = -travel;
    parts[2].kappa = 1;
    face(shape, parts, 0, 1);
  }
};

/// With carriages in place of arms.
struct LinearI4 : I4 {
  static constexpr const char* kClass = "LinearI4";
  static constexpr DriveKind kDrive = DriveKind::prismatic;
};

}  // namespace deltadyn
