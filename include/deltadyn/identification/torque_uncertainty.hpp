#pragma once

/// \file
/// How well the torque is known that an identified model gives: the uncertainty of the base parameters carried to the
/// drives. It says what the relative standard deviations of single parameters cannot: a poorly seen one matters only
/// where it acts.

#include <Eigen/Core>
#include <cstdint>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/identification/validate.hpp"

namespace deltadyn {

/// One value a drive, over a set of states.
struct TorqueUncertainty {
  Eigen::VectorXd std;         ///< root mean square of the model torque's standard deviation [N m | N]
  Eigen::VectorXd rms_torque;  ///< root mean square model torque [N m | N]
  Eigen::Index states = 0;

  /// Largest std over rms torque of all drives.
  [[nodiscard]] double worst_relative() const;
};

/// On given states, each matrix states x drives. States without a regressor (singular poses) are left out.
/// \param covariance  of the base parameters
/// \param p           parameters in the robot's layout
/// Throws deltadyn::Error for sizes that do not fit, and if no state is left.
[[nodiscard]] TorqueUncertainty torque_uncertainty(const Robot& robot, const BaseParameters& base,
                                                   const Eigen::MatrixXd& covariance, const Eigen::VectorXd& p,
                                                   const Eigen::MatrixXd& q, const Eigen::MatrixXd& qd,
                                                   const Eigen::MatrixXd& qdd);

/// On the rows of logs, at most `states` of them, evenly spread.
[[nodiscard]] TorqueUncertainty torque_uncertainty_on_logs(const Robot& robot, const BaseParameters& base,
                                                           const Eigen::MatrixXd& covariance, const Eigen::VectorXd& p,
                                                           const Validation& logs, int states = 1000);

/// On random fast motions over the workspace (WorkspaceSampler), also where the logs did not go.
[[nodiscard]] TorqueUncertainty torque_uncertainty_in_workspace(const Robot& robot, const BaseParameters& base,
                                                                const Eigen::MatrixXd& covariance,
                                                                const Eigen::VectorXd& p, int states = 1000,
                                                                std::uint64_t seed = 1);

/// How much each parameter does: the rms torque that its value makes on random fast motions over the workspace, as a
/// share of the drive's rms torque, largest over the drives. One value a parameter.
[[nodiscard]] Eigen::VectorXd parameter_effect(const Robot& robot, const Eigen::VectorXd& p, int states = 1000,
                                               std::uint64_t seed = 1);

}  // namespace deltadyn
