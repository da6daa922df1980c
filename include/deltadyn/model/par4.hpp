#pragma once

/// \file
/// Four limbs and a plate that is a planar parallelogram (Pierrot, Nabat et al. 2009): limbs 1 and 2 hold one half, 3
/// and 4 the other, two bars join them by four hinges, and a gear or belt turns the tool faster than the bars.

#include "deltadyn/model/h4.hpp"

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
    const Vector3<double> hinge = 0.5 * shape.spacing * shape.outwards();
    const Vector3<double> bar = 0.5 * shape.bar_spacing * cross_z<double>(shape.outwards());
    parts[0].a = hinge;
    parts[1].a = -hinge;
    parts[2].c = bar;
    parts[3].c = -bar;
    parts[2].kappa = parts[3].kappa = 1;
    parts[4].kappa = shape.ratio;
    if (shape.tool == ToolPlace::half_plate) parts[4].a = hinge;
    parts[0].turn = parts[2].turn = shape.azimuth;
    parts[1].turn = parts[3].turn = shape.azimuth + 3.14159265358979323846;  // the same parts, the other way round
  }
};

/// With carriages in place of arms.
struct LinearPar4 : Par4 {
  static constexpr const char* kClass = "LinearPar4";
  static constexpr DriveKind kDrive = DriveKind::prismatic;
};

}  // namespace deltadyn
