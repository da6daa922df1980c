#pragma once

/// \file
/// Names that the writer and the reader of robot files agree on.

#include <cstddef>
#include <fmt/format.h>
#include <string>

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

}  // namespace deltadyn::robot_file
