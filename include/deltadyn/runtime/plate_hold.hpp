#pragma once

/// \file
/// Whether the limbs hold the halves of an articulated plate level.

#include <Eigen/Core>

#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

/// Two struts with balls at both ends stop one turn of the part that they hold, about their parallelogram's normal.
/// Two limbs thus leave a half one axis to tip about, and the rest of the plate must stop it: bars or a slide do, but a
/// crossbar on upright hinges passes on the tipping itself. Then the axes of both halves must not be parallel as seen
/// from above, or the halves tip together.
/// \return sine of the angle between the two axes, seen from above; 1 where bars or a slide hold the halves, or where
///         the plate is rigid
/// Throws deltadyn::Error if q is out of reach or singular.
[[nodiscard]] double tipping_margin(const Robot& robot, const Eigen::VectorXd& q);

/// Below it a plate has visible play.
inline constexpr double kLeastTippingMargin = 0.05;

/// What to do then: flags of delta-model create.
inline constexpr const char* kTippingMend =
    "a real h4 has its limbs in three directions: --limb-azimuth-rad 0,-1.5708,3.1416,-1.5708 --plate-azimuth-rad 0 "
    "with, for hinges 0.12 m apart, --drive-places-m '0.2,0,0;0.06,-0.2,0;-0.2,0,0;-0.06,-0.2,0' --attachments-m "
    "'0.03,0,0;0,-0.05,0;-0.03,0,0;0,-0.05,0'; level motion is described rightly as it is";

}  // namespace deltadyn
