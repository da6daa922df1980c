#pragma once

/// \file
/// Where a robot can work: the poses that its drives reach without passing a singular pose.

#include <Eigen/Core>

#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

/// The connected region around the home pose, as cells of a grid; inside the drives' position limits, an articulated
/// plate in its middle.
struct Reach {
  Eigen::Vector3d home = Eigen::Vector3d::Zero();   ///< pose where the search starts [m]
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();  ///< smallest x, y, z of the plate's centre [m]
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();  ///< largest x, y, z [m]
  double radius = 0;                                ///< largest distance from the z axis [m]
  double volume = 0;                                ///< [m^3]
  double cell = 0;                                  ///< edge of a cell: the accuracy of all lengths here [m]
  double condition_best = 0, condition_median = 0,
         condition_worst_of_95 = 0;  ///< 95 % of the region are better than the last one
  /// Of an articulated plate: the part of the region's volume that is left with the plate turned as far as it goes, to
  /// the worse side; the rest is out of reach or near a singular pose of the plate there
  double share_at_full_turn = 1;
  Eigen::MatrixX3d points;    ///< centres of the cells [m]
  Eigen::VectorXd condition;  ///< at the centres
};

/// \param cells  of the grid along each of x, y, z
/// Throws deltadyn::Error if the robot has no plate, or no pose at all is within reach and limits.
[[nodiscard]] Reach find_reach(const Robot& robot, int cells = 61);

}  // namespace deltadyn
