#pragma once

/// \file
/// Which columns of a compile-time layout a robot with given options has.

#include <algorithm>
#include <vector>

#include "deltadyn/model/parameter_layout.hpp"
#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

/// Columns of ParameterLayout<R, kSharing> in the order of Robot::parameter_names().
template <class R, Limbs kSharing>
std::vector<int> layout_columns(const ParameterOptions& options) {
  using Layout = ParameterLayout<R, kSharing>;
  std::vector<int> columns;
  for (int column = 0; column < Layout::kColumns; ++column) {
    const bool tool =
        R::kTelescope && column / kInertialParameters == Layout::body(Body::tool, 0) && column < Layout::kFriction;
    const bool rotor = column >= Layout::kRotorInertia && column < Layout::kOffset;
    const bool wanted_rotor =
        std::count(options.rotor_inertia.begin(), options.rotor_inertia.end(), column - Layout::kRotorInertia + 1) > 0;
    const bool offset = column >= Layout::kOffset;
    if ((tool && !options.tool) || (rotor && !wanted_rotor) || (offset && !options.offset)) continue;
    columns.push_back(column);
  }
  return columns;
}

}  // namespace deltadyn
