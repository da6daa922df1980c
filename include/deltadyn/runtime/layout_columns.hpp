#pragma once

/// \file
/// Which columns of a compile-time layout a robot with given options has, and how both layouts go together.

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

/// The same for a layout that is chosen at run time.
template <class R>
std::vector<int> layout_columns(const ParameterOptions& options) {
  return options.individual_limbs ? layout_columns<R, Limbs::individual>(options)
                                  : layout_columns<R, Limbs::shared>(options);
}

/// For each column of the layout of individual limbs, that of the layout of shared ones which holds the same value.
template <class R>
std::vector<int> shared_columns() {
  using Own = ParameterLayout<R, Limbs::individual>;
  using Shared = ParameterLayout<R, Limbs::shared>;
  std::vector<int> columns(static_cast<std::size_t>(Own::kColumns));
  const auto add = [&columns](int own, int shared, int count) {
    for (int k = 0; k < count; ++k) columns[static_cast<std::size_t>(own + k)] = shared + k;
  };
  const auto add_body = [&add](Body kind, int index) {
    add(kInertialParameters * Own::body(kind, index), kInertialParameters * Shared::body(kind, index),
        kInertialParameters);
  };
  for (int i = 0; i < R::kLimbs; ++i) add_body(Body::upper_arm, i);
  for (int i = 0; i < (kHasPlate<R> ? R::kLimbs : 0); ++i) add_body(Body::strut, i);
  for (int k = 0; k < R::kPlateParts; ++k) add_body(R::kParts[k], k);
  if (R::kTelescope)
    for (const Body body : {Body::tool, Body::telescope_upper, Body::telescope_lower}) add_body(body, 0);
  add(Own::kFriction, Shared::kFriction, Own::kColumns - Own::kFriction);
  return columns;
}

/// For each column of the layout of individual limbs its place among Robot::parameter_names(); -1: it has none. Limbs
/// that share a parameter have the same place.
template <class R>
std::vector<int> layout_entries(const ParameterOptions& options) {
  const std::vector<int> columns = layout_columns<R>(options);
  std::vector<int> entries = shared_columns<R>();
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const int column = options.individual_limbs ? static_cast<int>(k) : entries[k];
    const auto found = std::find(columns.begin(), columns.end(), column);
    entries[k] = found == columns.end() ? -1 : static_cast<int>(found - columns.begin());
  }
  return entries;
}

}  // namespace deltadyn
