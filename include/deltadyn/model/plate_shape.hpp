#pragma once

/// \file
/// Lengths of an articulated plate, as a drawing has them; the types (h4.hpp, i4.hpp, par4.hpp) make parts of them.

#include <cmath>
#include <limits>

#include "deltadyn/model/geometry.hpp"

namespace deltadyn {

enum class ToolPlace { centre, half_plate };

/// Stands for a length that a type needs and nobody has given yet.
inline constexpr double kNeeded = std::numeric_limits<double>::quiet_NaN();

/// What a type does not have is 0, and it does not look at it. The static function usual() of a type holds kNeeded for
/// what must be given, and defaults for the rest.
struct PlateShape {
  double azimuth = 1.5707963267948966;  ///< of half plate 1 from the plate's centre, about z of W, at theta = 0 [rad]
  double spacing = 0;                   ///< between the hinges of the two halves (h4, par4) [m]
  double bar_spacing = 0;               ///< between the two bars of the parallelogram (par4) [m]
  double pinion_radius = 0;             ///< (i4) [m]
  double ratio = 1;                     ///< turns of the tool a turn of theta: gear or belt (h4, par4)
  ToolPlace tool = ToolPlace::centre;   ///< where the tool's axis stands (par4)
  double range = 0;                     ///< largest theta to either side [rad]

  /// Unit vector from the plate's centre to half plate 1.
  [[nodiscard]] Vector3<double> outwards() const { return {std::cos(azimuth), std::sin(azimuth), 0}; }
};

}  // namespace deltadyn
