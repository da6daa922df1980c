#pragma once

/// \file
/// The even time grid behind recorded time stamps.

#include <Eigen/Core>
#include <vector>

namespace deltadyn {

/// Sample i of the recording belongs to grid point index[i], at start_s + index[i] * step_s.
struct TimeGrid {
  double start_s = 0.0;
  double step_s = 0.0;
  std::vector<Eigen::Index> index;  ///< strictly increasing from 0; a jump by more than 1 is a gap
  double jitter = 0.0;              ///< largest distance of a stamp from its grid point, share of step_s
  Eigen::Index worst = 0;           ///< sample with this distance
};

/// Least-squares grid. Prefers a grid without gaps unless leaving grid points out fits clearly better.
/// \param t_s  at least two strictly increasing stamps [s]
[[nodiscard]] TimeGrid fit_time_grid(const Eigen::Ref<const Eigen::VectorXd>& t_s);

}  // namespace deltadyn
