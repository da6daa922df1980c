#pragma once

/// \file
/// The regularisation D(p, p_reg) of one block, as a sum of squares for Ceres and as value, gradient, Hessian for the
/// convex solver.

#include <Eigen/Core>

#include "fit_blocks.hpp"

namespace deltadyn::fit {

/// True if the block is compared entry by entry under this metric.
[[nodiscard]] bool is_relative(const Block& block, FitMetric metric);

/// Rows of the block's residual.
[[nodiscard]] int residual_size(const Block& block, FitMetric metric);

/// residual^T residual = D of the block at its fitted entries y. For the divergences the residual is the symmetric
/// matrix rho(L), L = C^T Q(y) C, Q(prior)^{-1} = C C^T, as a vector (off-diagonals times sqrt 2), with
///   bregman:    rho(l) = sign(l - 1) sqrt(l - 1 - log l), so that D = tr L - log det L - n exactly
///   riemannian: rho(l) = log(l) / sqrt 2.
/// Both rho are smooth through l = 1. The Jacobian uses divided differences of rho (Daleckii and Krein), which stay
/// smooth where eigenvalues meet. jacobian may be null. Returns false if Q(y) is not positive definite.
bool metric_residual(const Block& block, const Layout& layout, FitMetric metric,
                     const Eigen::Ref<const Eigen::VectorXd>& y, Eigen::Ref<Eigen::VectorXd> residual,
                     Eigen::MatrixXd* jacobian);

/// -log det of a linear matrix, with gradient and Hessian. Returns false outside the cone.
bool log_det_barrier(const LinearMatrix& matrix, const Eigen::Ref<const Eigen::VectorXd>& x, double& value,
                     Eigen::VectorXd* gradient, Eigen::MatrixXd* hessian);

/// D of the block with gradient and Hessian in the fitted entries. The Hessian is exact for `relative` and `bregman`
/// (both convex); for `riemannian` it is that of Gauss and Newton, which is positive definite where the exact one need
/// not be.
bool metric_terms(const Block& block, const Layout& layout, FitMetric metric,
                  const Eigen::Ref<const Eigen::VectorXd>& y, double& value, Eigen::VectorXd* gradient,
                  Eigen::MatrixXd* hessian);

}  // namespace deltadyn::fit
