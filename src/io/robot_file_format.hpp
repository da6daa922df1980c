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

/// The `<plate>` of a robot file.
struct PlateNumber {
  const char* key;
  double PlateShape::*member;
};
inline constexpr PlateNumber kPlateNumbers[] = {
    {"azimuth_rad", &PlateShape::azimuth},
    {"spacing_m", &PlateShape::spacing},
    {"bar_spacing_m", &PlateShape::bar_spacing},
    {"pinion_radius_m", &PlateShape::pinion_radius},
    {"ratio", &PlateShape::ratio},
    {"range_rad", &PlateShape::range},
};
inline const char* tool_place_name(ToolPlace place) {
  return place == ToolPlace::centre ? "centre" : "half_plate";
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
/// Where it ends on the plate, from the origin of the plate part that holds the limb, in W.
inline Vector3<double> strut_end(const LimbGeometry<double>& limb, bool first) {
  const double half = (first ? 0.5 : -0.5) * limb.strut_spacing;
  return limb.p_BA + half * Vector3<double>(limb_frame(limb).col(1));
}

/// R_WL as a URDF's rpy.
inline Vector3<double> limb_rpy(const LimbGeometry<double>& limb) {
  return {limb.tilt, 0, limb.azimuth};
}
/// R_LW as a URDF's rpy.
inline Vector3<double> inverse_limb_rpy(const LimbGeometry<double>& limb) {
  if (limb.tilt == 0) return {0, 0, -limb.azimuth};
  const Matrix3<double> R = limb_frame(limb).transpose();
  return {std::atan2(R(2, 1), R(2, 2)), std::asin(-R(2, 0)), std::atan2(R(1, 0), R(0, 0))};
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
