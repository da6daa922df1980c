#pragma once

/// \file
/// A robot with an articulated plate as the drawing that the oracle in bodies takes. Parts are not looked at: the
/// oracle has its own idea of where they are.

#include <type_traits>

#include "deltadyn/model/i4.hpp"
#include "deltadyn/model/par4.hpp"

#include "oracles/four_limbs.hpp"
#include "support/oracle_of.hpp"

namespace deltadyn::testing_support {

template <class Robot>
oracles::bodies::Drawing drawing_of(const Geometry<double, Robot>& geometry, const PlateShape& shape) {
  using oracles::Real;
  using oracles::bodies::PlateKind;
  oracles::bodies::Drawing drawing;
  drawing.prismatic = Robot::kDrive == DriveKind::prismatic;
  drawing.limbs = oracle_of(geometry).limbs;
  drawing.kind = std::is_base_of_v<I4, Robot>     ? PlateKind::rack_and_pinion
                 : std::is_base_of_v<Par4, Robot> ? PlateKind::parallelogram
                                                  : PlateKind::hinged_bar;
  drawing.azimuth = Real(shape.azimuth);
  drawing.spacing = Real(shape.spacing);
  drawing.bar_spacing = Real(shape.bar_spacing);
  drawing.pinion_radius = Real(shape.pinion_radius);
  drawing.ratio = Real(shape.ratio);
  drawing.tool_on_half = shape.tool == ToolPlace::half_plate;
  drawing.gravity = geometry.gravity.template cast<Real>();
  return drawing;
}

}  // namespace deltadyn::testing_support
