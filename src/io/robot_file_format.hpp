#pragma once

/// \file
/// Names, numbers and places that the writers and the reader of robots agree on.

#include <cmath>
#include <cstddef>
#include <fmt/format.h>
#include <string>

#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/model/inertial_parameters.hpp"

namespace deltadyn::robot_file {

/// Stands for "no limit" in a URDF <limit>; anything at least as large is read as infinite.
inline constexpr double kUnlimited = 1e30;
inline const char* acceleration_attribute(bool prismatic) {
  return prismatic ? "acceleration_limit_m_s2" : "acceleration_limit_rad_s2";
}

inline std::string drive_name(std::size_t index) {
  return fmt::format("drive{}", index + 1);
}
/// Strut a stands at +y of the limb frame, strut b at -y.
inline std::string strut_name(std::size_t limb, bool first) {
  return fmt::format("strut{}{}", limb + 1, first ? 'a' : 'b');
}
/// Where it begins on the upper arm or carriage, in the limb's frame.
inline Vector3<double> strut_elbow(const LimbGeometry<double>& limb, bool first) {
  return limb.p_DE_0 + Vector3<double>(0, (first ? 0.5 : -0.5) * limb.strut_spacing, 0);
}
/// Where it ends on the plate, from the plate's centre.
inline Vector3<double> strut_end(const LimbGeometry<double>& limb, bool first) {
  const double half = (first ? 0.5 : -0.5) * limb.strut_spacing;
  return limb.p_BA + half * Vector3<double>(-std::sin(limb.azimuth), std::cos(limb.azimuth), 0);
}

/// The number of a text that reads back exactly; no "-0" in a file that people read.
inline std::string text(double value) {
  return value == 0 ? "0" : fmt::format("{}", value);
}
inline std::string text(const Vector3<double>& v) {
  return fmt::format("{} {} {}", text(v.x()), text(v.y()), text(v.z()));
}

/// 0 if there is none of this name.
inline double value_of(const NamedValues& values, const std::string& name) {
  const auto found = values.find(name);
  return found == values.end() ? 0.0 : found->second;
}
/// The ten parameters of a body, 0 where they are not given.
inline InertialVector<double> body_of(const NamedValues& values, const std::string& body) {
  InertialVector<double> p;
  for (int k = 0; k < kInertialParameters; ++k) p(k) = value_of(values, body + "." + kInertialNames[k]);
  return p;
}

}  // namespace deltadyn::robot_file
