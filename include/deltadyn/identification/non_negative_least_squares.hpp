#pragma once

/// \file
/// Least squares of which some unknowns may not become negative, from the Gram matrix (Lawson, Hanson, Solving Least
/// Squares Problems, 1974, chapter 23).

#include <Eigen/Core>
#include <vector>

namespace deltadyn {

struct NonNegativeSolution {
  Eigen::VectorXd x;       ///< k; 0 where `free` is false
  std::vector<bool> free;  ///< k: the columns that take part; the others are at their bound, or empty
  double gain = 0;         ///< fall of the sum of squares from that of x = 0
};

/// Minimises |C x - r|^2 over x with x_i >= 0 where `positive`. Columns whose square in `gram` is not above 0 take no
/// part. Where columns depend on each other, the solution of least norm in columns of norm 1 is taken.
/// \param gram      k x k, C^T C
/// \param inner     k, C^T r
/// \param positive  k
/// \param singular  a direction of the columns of norm 1 that is weaker than this share of the strongest is rounding
[[nodiscard]] NonNegativeSolution non_negative_least_squares(const Eigen::MatrixXd& gram, const Eigen::VectorXd& inner,
                                                             const std::vector<bool>& positive, double singular = 1e-8);

}  // namespace deltadyn
