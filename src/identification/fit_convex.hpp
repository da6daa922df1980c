#pragma once

/// \file
/// The fit as a convex problem in p: an interior-point solver in p and the certificate of global optimality.

#include <Eigen/Core>
#include <optional>

#include "fit_blocks.hpp"

namespace deltadyn::fit {

/// ||A y - b||^2 + lambda D(y) over the cones, prepared once for any number of lambdas.
class ConvexProblem {
 public:
  /// \param A  rows x fitted columns
  ConvexProblem(const Layout& layout, const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

  struct Result {
    Eigen::VectorXd x;
    int iterations = 0;
    bool converged = false;
  };
  /// Follows the central path from `start` down to a duality gap that is negligible in units of chi^2.
  /// With `riemannian` the problem is not convex and the result is a local minimum.
  [[nodiscard]] Result minimise(FitMetric metric, double lambda, const Eigen::VectorXd& start) const;

  /// Evidence at a point, valid for any of the consistent set.
  /// \param x  y alone, or the whole result of minimise(): then the barrier there gives the dual point
  [[nodiscard]] OptimalityCertificate certify(FitMetric metric, double lambda, const Eigen::VectorXd& x) const;

  [[nodiscard]] double data_cost(const Eigen::VectorXd& y) const { return (A_ * y - b_).squaredNorm(); }
  [[nodiscard]] double regularization_cost(FitMetric metric, const Eigen::VectorXd& y) const;
  /// J
  [[nodiscard]] double cost(FitMetric metric, double lambda, const Eigen::VectorXd& y) const {
    return data_cost(y) + lambda * regularization_cost(metric, y);
  }

 private:
  struct Terms {
    double value = 0;
    Eigen::VectorXd gradient;
    Eigen::MatrixXd factor;  // block triangular: Hessian = factor factor^T, in units of the scale
  };
  bool separable_terms(FitMetric metric, double lambda, double barrier, const Eigen::VectorXd& x, Terms& terms,
                       bool derivatives) const;
  struct Newton {
    Eigen::VectorXd step;  // of x, scaled
    double decrement = 0;  // what the gradient promises for it, twice what it gains
  };
  /// A point, scaled, and what it leaves of the data.
  struct Iterate {
    Eigen::VectorXd x, residual;
  };
  [[nodiscard]] bool search_line(FitMetric metric, double lambda, double barrier, const Terms& terms,
                                 const Newton& newton, Iterate& at) const;
  [[nodiscard]] Newton newton_step(const Terms& terms, const Eigen::VectorXd& residual) const;
  [[nodiscard]] Eigen::VectorXd residual_at(const Eigen::VectorXd& scaled) const;  // in the singular directions
  [[nodiscard]] std::optional<Eigen::VectorXd> barrier_dual(FitMetric metric, double lambda,
                                                            const Eigen::VectorXd& x) const;

  const Layout& layout_;
  Eigen::MatrixXd A_;
  Eigen::VectorXd b_;
  Eigen::VectorXd scale_;     // of x
  Eigen::VectorXd centring_;  // of x: linear part of the barrier, which puts its minimum at the anchors
  Eigen::VectorXd singular_;  // of A diag(scale)
  Eigen::MatrixXd V_;         // right singular vectors
  Eigen::VectorXd target_;    // U^T b
};

}  // namespace deltadyn::fit
