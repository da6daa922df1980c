#pragma once

/// \file
/// The inertia that a drive moves.

#include <Eigen/Core>

#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

/// Inertia of each drive with the others held, in the middle of their limits; where that is no pose, with all drives at
/// 0 [kg m^2 | kg]. Parameters that are not physical, as a free fit to a slow log may have them, can give any sign.
/// Throws deltadyn::Error if neither is a pose of the robot.
[[nodiscard]] Eigen::VectorXd drive_inertia(const Robot& robot, const Eigen::VectorXd& p);

}  // namespace deltadyn
