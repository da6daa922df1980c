#pragma once

/// \file
/// What makes an articulated plate of four limbs work: rules on a description.

#include <string>
#include <vector>

#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn {

/// Sine of an angle between directions that count as parallel.
inline constexpr double kParallel = 1e-6;

/// Largest sine between the directions across the struts of limbs on one part of the plate, in the base frame: each
/// parallelogram stops the turn about its own direction, so parallel ones leave the part loose.
[[nodiscard]] double largest_angle_between_limbs(const std::vector<LimbGeometry<double>>& limbs, int part);

/// Between the azimuths of neighbouring limbs [rad].
[[nodiscard]] double widest_gap(const std::vector<LimbGeometry<double>>& limbs);

namespace articulated_plate {

/// The lengths of the plate itself, and its gear: what a robot file tells in one place.
void validate_shape(const RobotDescription& robot, const std::string& where);

/// Throws deltadyn::Error with the rule that is broken.
void validate(const RobotDescription& robot, const std::string& where);

}  // namespace articulated_plate
}  // namespace deltadyn
