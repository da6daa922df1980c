#pragma once

/// \file
/// How much information any motion can give at best: the D-optimal approximate design over the admissible states
/// (Kiefer and Wolfowitz 1960).

#include <Eigen/Core>

#include "deltadyn/excitation/design_space.hpp"

namespace deltadyn {

/// The best shares of time for states that a motion may pass, whatever their order.
struct DesignBound {
  double log_det = 0;        ///< upper bound of log det M a sample, scaled columns: no shares on the states give more
  double log_det_found = 0;  ///< of the design found
  Eigen::VectorXd shares;    ///< of each state of the space, sum 1
  int support = 0;           ///< states with a share
  [[nodiscard]] double gap(int p) const;  ///< 1 - efficiency of the design found against the bound
};

/// Multiplicative algorithm on a growing set of states; the bound is certified by the equivalence theorem: with
/// d_max = max tr(M_state M^-1), det M* <= (d_max / p)^p det M.
/// Throws deltadyn::Error(no_convergence) if the states do not show all base parameters.
[[nodiscard]] DesignBound design_bound(const DesignSpace& space);

/// (det M / det M_bound)^(1/p).
[[nodiscard]] double d_efficiency(double log_det, const DesignBound& bound, int p);

}  // namespace deltadyn
