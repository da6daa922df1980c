#pragma once

/// \file
/// Torque that given parameters predict for a log, beside the measured one, under the same processing as in a fit.

#include <Eigen/Core>

#include "deltadyn/identification/log_processing.hpp"

namespace deltadyn {

/// Rows of a prepared log. All matrices rows x drives.
struct Prediction {
  Eigen::VectorXd t_s;
  Eigen::MatrixXd tau, model;  ///< measured and predicted torque, filtered alike [N m | N]
  Eigen::MatrixXd q, qd, qdd;  ///< of the row's sample
  RowUses use;

  [[nodiscard]] Eigen::MatrixXd residual() const { return tau - model; }
  [[nodiscard]] Eigen::Index rows() const { return tau.rows(); }
  [[nodiscard]] Eigen::Array<bool, Eigen::Dynamic, 1> usable(int drive, bool with_reversals) const {
    return usable_rows(use, drive, with_reversals);
  }
  /// Root mean square residual over usable rows [N m | N]; 0 without any.
  [[nodiscard]] double rms_residual(int drive, bool with_reversals) const;
  /// Root mean square measured torque over the same rows.
  [[nodiscard]] double rms_torque(int drive, bool with_reversals) const;
};

/// \param p  parameters in the robot's layout
[[nodiscard]] Prediction predict(const Robot& robot, const PreparedLog& log, const Eigen::VectorXd& p, int threads = 0);

}  // namespace deltadyn
