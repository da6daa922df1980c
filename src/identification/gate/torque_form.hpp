#pragma once

/// \file
/// Every way to assign, turn and scale the recorded torques, judged from one fold: for a given reading of the positions
/// the residual is a quadratic form of the drives' torque factors.

#include <Eigen/Core>
#include <vector>

#include "rows.hpp"

namespace deltadyn::gate {

/// Rows of one drive folded with all torque columns beside each other, means taken off (a torque offset is nobody's
/// fault here). Normal equations: what they lose in precision, a millionth of the torque, is far below what is told
/// apart here.
struct TorqueBlock {
  Eigen::MatrixXd YtY;   ///< base x base
  Eigen::MatrixXd Ytau;  ///< base x columns
  Eigen::VectorXd tau2;  ///< sum of squares of each torque column
  Eigen::Index rows = 0;
};

/// \param tau  points x columns, for rows of rows_of_points()
[[nodiscard]] std::vector<TorqueBlock> fold_torques(const Rows& rows, const Eigen::MatrixXd& tau);

/// S with s^T S s = sum over the drives of (residual / torque)^2 when drive j's torque is s_j factor_j times column
/// assignment[j].
/// \param factor  none of them 0; each drive's residual is counted against its torque times this
[[nodiscard]] Eigen::MatrixXd residual_form(const std::vector<TorqueBlock>& blocks, const std::vector<int>& assignment,
                                            const Eigen::VectorXd& factor);

/// Relative residual of factors s near +-1: root of the mean over the drives.
[[nodiscard]] double relative_residual(const Eigen::MatrixXd& form, const Eigen::VectorXd& s);

/// Relative residual of each drive with parameters of its own.
[[nodiscard]] Eigen::VectorXd own_residuals(const std::vector<TorqueBlock>& blocks);

/// The factor of one drive's torque that leaves least, the others' being 1, with its standard deviation by the
/// residual.
struct Factor {
  double value = 1, std = 0;
};
[[nodiscard]] Factor best_factor(const std::vector<TorqueBlock>& blocks, const std::vector<int>& assignment, int drive);

}  // namespace deltadyn::gate
