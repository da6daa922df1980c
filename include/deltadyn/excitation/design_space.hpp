#pragma once

/// \file
/// What an excitation is designed for: the robot's base columns, their weights, the limits, and the states that these
/// allow.

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "deltadyn/excitation/task_regressor.hpp"
#include "deltadyn/trajectory/motion_limits.hpp"

namespace deltadyn {

/// States (z, zd, zdd) drawn at random inside all limits (paper IV.A), column by column.
struct AdmissibleStates {
  Eigen::MatrixXd x;  ///< 3 N x count
  /// Pose with the most room among those drawn, in torque to hold itself too where that is limited [m; rad].
  Eigen::VectorXd centre;
  int drawn = 0;  ///< states that were tried
};

/// Poses uniform in the workspace, rates uniform in the boxes of their limits; where the task space has no limit of its
/// own, in the box of the drives. What breaks a limit is thrown away. Same seed, same states. Throws deltadyn::Error
/// that names the limit that binds if (nearly) nothing is left: the workspace cannot be reached or the limits
/// contradict each other.
[[nodiscard]] AdmissibleStates admissible_states(const Robot& robot, const TaskRegressor& regressor,
                                                 const MotionLimits& limits, int count, std::uint64_t seed);

/// Everything that the information of a motion depends on besides the motion.
struct DesignSpace {
  const Robot* robot = nullptr;
  std::shared_ptr<const TaskRegressor> regressor;
  std::vector<int> base_columns;  ///< linearly independent columns of the regressor (QR, paper IV.A)
  Eigen::VectorXd torque_scale;   ///< one a drive [N m | N]: W = diag(scale)^-2
  AdmissibleStates states;
  Eigen::VectorXd column_scale;  ///< root mean square of each weighted base column over the states
  Eigen::VectorXd coordinate_scale, rate_scale, acceleration_scale;  ///< half the spread of z, zd, zdd over the states

  [[nodiscard]] int base_parameters() const { return static_cast<int>(base_columns.size()); }
  /// Weighted and scaled base columns of one state, N x p; true Coulomb signs.
  [[nodiscard]] Status weighted_columns(const Eigen::Ref<const Eigen::VectorXd>& x,
                                        Eigen::Ref<Eigen::MatrixXd> A) const;
  /// 2 sum log(column_scale): what log det M in physical units has more than in scaled columns.
  [[nodiscard]] double log_det_of_scales() const;
};

/// \param base_columns  as BaseParameters::independent
[[nodiscard]] DesignSpace make_design_space(const Robot& robot, const MotionLimits& limits,
                                            const std::vector<int>& base_columns, const Eigen::VectorXd& torque_scale,
                                            int states, std::uint64_t seed);

}  // namespace deltadyn
