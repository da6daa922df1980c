#pragma once

/// \file
/// Is a torque residual noise, or does it follow the motion? What follows the velocity, the position or the
/// acceleration of a drive is physics that the model lacks, and says where to look: friction, load and geometry,
/// inertia.

#include <Eigen/Core>
#include <vector>

#include "deltadyn/identification/validate.hpp"

namespace deltadyn {

/// How far a residual is a function of one coordinate.
struct DependenceOnMotion {
  /// Of the residual's mean square that a curve over the coordinate explains, chance taken out; 0 to 1
  double share = 0;
  double p_value = 1;  ///< chance of a curve that good without any dependence
};

/// The residual of one drive, rows near velocity reversals left out.
struct ResidualStructure {
  DependenceOnMotion on_velocity, on_position, on_acceleration;  ///< of the drive itself
  /// DriveNoise::correlation; 1: every row is news, 10: ten rows tell as much as one of white noise
  double correlation = 1;
  Eigen::Index rows = 0;  ///< looked at
};

/// Compares the means of the residual in intervals of each coordinate with the means that the same residual gives when
/// it is shifted along the log: a shift keeps the residual's own memory and takes its relation to the motion away. Rows
/// of all logs together; a drive with too few rows gets the neutral values.
[[nodiscard]] std::vector<ResidualStructure> residual_structure(const Validation& validation);

/// The same for any residual over any coordinate, N values each.
[[nodiscard]] DependenceOnMotion dependence_on(const Eigen::VectorXd& coordinate, const Eigen::VectorXd& residual);

}  // namespace deltadyn
