#pragma once

/// \file
/// Is the mass matrix of an identified model positive definite wherever the robot works? Without that, forward dynamics
/// and controllers built on the model can fail (paper V).

#include <Eigen/Core>
#include <cstdint>

#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

/// What random poses of the workspace show. Eigenvalues in the unit of M: kg m^2, or kg for prismatic drives.
struct MassMatrixSurvey {
  int states = 0;             ///< poses looked at
  int not_positive = 0;       ///< of these, poses where the Cholesky factorisation fails
  double min_eigenvalue = 0;  ///< smallest one of all poses
  double max_eigenvalue = 0;  ///< largest one of all poses
  /// Largest ratio of the eigenvalues of one pose; infinite where M is not positive definite
  double worst_condition = 1;
  Eigen::VectorXd q_min, z_min;  ///< pose of the smallest eigenvalue: drives [rad | m] and task coordinates [m, rad]
  Eigen::MatrixXd task;          ///< kept poses x drives: task coordinates, for pictures
  Eigen::MatrixXd eigenvalues;   ///< kept poses x drives: ascending in each row

  [[nodiscard]] bool positive_definite() const { return not_positive == 0; }
};

/// Looks at `states` random poses inside the reach.
/// \param p     parameters in the robot's layout
/// \param keep  poses kept for pictures, at most
/// Throws deltadyn::Error if a count is not positive, p has the wrong size, or the geometry has no regular pose.
[[nodiscard]] MassMatrixSurvey survey_mass_matrix(const Robot& robot, const Eigen::VectorXd& p, int states,
                                                  std::uint64_t seed = 1, int keep = 2000);

}  // namespace deltadyn
