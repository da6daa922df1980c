#pragma once

/// \file
/// Four limbs and a plate that is a planar parallelogram (Pierrot, Nabat et al. 2009): limbs 1 and 2 hold one half, 3
/// and 4 the other, two bars join them by four hinges, and a gear or belt turns the tool faster than the bars.

#include "deltadyn/model/four_limbs.hpp"

namespace deltadyn {

struct Par4 : FourLimbs {
  static constexpr const char* kName = "par4";
  static constexpr const char* kClass = "Par4";
  static constexpr int kPlateParts = 5;
  static constexpr Body kParts[] = {Body::half_plate, Body::half_plate, Body::crossbar, Body::crossbar, Body::tool};

  static PlateShape usual() {
    PlateShape shape;
    shape.spacing = shape.bar_spacing = kNeeded;
    shape.ratio = 4;
    shape.range = 0.9;
    return shape;
  }
  static constexpr bool kGeared = true;
  static constexpr bool kToolOnAHalf = true;

  static void place_parts(const PlateShape& shape, PlatePart<double> (&parts)[kPlateParts]) {
    for (PlatePart<double>& part : parts) part = {};
    hinge_halves(shape, parts);
    const Vector3<double> bar = 0.5 * shape.bar_spacing * cross_z<double>(shape.outwards());
    parts[2].c = bar;
    parts[3].c = -bar;
    parts[2].kappa = parts[3].kappa = 1;
    face(shape, parts, 2, 3);
    parts[4].kappa = shape.ratio;
    if (shape.tool == ToolPlace::half_plate) parts[4].a = parts[0].a;
  }
};

/// With carriages in place of arms.
struct LinearPar4 : Par4 {
  static constexpr const char* kClass = "LinearPar4";
  static constexpr DriveKind kDrive = DriveKind::prismatic;
};

}  // namespace deltadyn
