#pragma once

/// \file
/// Four limbs and a plate in the shape of an H (Pierrot, Company 1999): limbs 1 and 2 hold one side bar, 3 and 4 the
/// other, and a crossbar joins them by two hinges.

#include "deltadyn/model/four_limbs.hpp"

namespace deltadyn {

struct H4 : FourLimbs {
  static constexpr const char* kName = "h4";
  static constexpr const char* kClass = "H4";
  static constexpr int kPlateParts = 4;
  static constexpr Body kParts[] = {Body::half_plate, Body::half_plate, Body::crossbar, Body::tool};

  static PlateShape usual() {
    PlateShape shape;
    shape.spacing = kNeeded;
    shape.range = 0.9;
    return shape;
  }
  static constexpr bool kGeared = true;        ///< a gear may stand between plate and tool
  static constexpr bool kToolOnAHalf = false;  ///< the tool's axis may stand on a half plate

  static void place_parts(const PlateShape& shape, PlatePart<double> (&parts)[kPlateParts]) {
    for (PlatePart<double>& part : parts) part = {};
    hinge_halves(shape, parts);
    parts[2].kappa = 1;
    parts[2].turn = shape.azimuth;
    parts[3].kappa = shape.ratio;
  }
};

/// With carriages in place of arms.
struct LinearH4 : H4 {
  static constexpr const char* kClass = "LinearH4";
  static constexpr DriveKind kDrive = DriveKind::prismatic;
};

}  // namespace deltadyn
