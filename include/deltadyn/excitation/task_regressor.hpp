#pragma once

/// \file
/// The regressor of paper (2) as a function of the task-space state (z, zd, zdd), with exact derivatives: what the
/// gradient of every criterion over a trajectory is made of.

#include <Eigen/Core>
#include <memory>

#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

/// State x = (z, zd, zdd): 3 N numbers for N drives. Drive motion (q, qd, qdd): 3 N numbers. Immutable, safe for
/// threads.
///
/// Coulomb columns: with a sign width w > 0 the sign of a joint rate v becomes v / sqrt(v^2 + w^2), so that sums over
/// the samples of a period are smooth in the coefficients; w = 0 is the sign itself, whose derivative counts as zero.
class TaskRegressor {
 public:
  virtual ~TaskRegressor() = default;

  [[nodiscard]] virtual int drives() const = 0;
  [[nodiscard]] virtual int parameters() const = 0;  ///< columns, as Robot::parameter_names()
  [[nodiscard]] virtual int friction_joints() const = 0;

  /// \param x            3 N
  /// \param sign_width   one a joint with friction [rad/s | m/s], or empty: zero
  /// \param Y            N x parameters
  /// \param drives       3 N: q, qd, qdd
  [[nodiscard]] virtual Status evaluate(const Eigen::Ref<const Eigen::VectorXd>& x,
                                        const Eigen::Ref<const Eigen::VectorXd>& sign_width,
                                        Eigen::Ref<Eigen::MatrixXd> Y, Eigen::Ref<Eigen::VectorXd> drives) const = 0;

  /// Gradients of sums sum_ij G_ij Y_ij(x) by x, and the Jacobian of the drive motion. Nearly all of the work is the
  /// motion, which all sums share.
  /// \param G          N x parameters of each sum, one below the other
  /// \param gradients  3 N of each sum, side by side
  /// \param jacobian   3 N x 3 N: d(q, qd, qdd) / dx
  [[nodiscard]] virtual Status differentiate(const Eigen::Ref<const Eigen::VectorXd>& x,
                                             const Eigen::Ref<const Eigen::VectorXd>& sign_width,
                                             const Eigen::Ref<const Eigen::MatrixXd>& G,
                                             Eigen::Ref<Eigen::MatrixXd> gradients,
                                             Eigen::Ref<Eigen::MatrixXd> jacobian) const = 0;
};

/// Throws deltadyn::Error if the type of the robot is not known.
[[nodiscard]] std::unique_ptr<TaskRegressor> make_task_regressor(const Robot& robot);

}  // namespace deltadyn
