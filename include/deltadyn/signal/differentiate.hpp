#pragma once

/// \file
/// Derivatives of evenly sampled signals.

#include <Eigen/Core>

namespace deltadyn {

/// Central differences of 2 * half_width + 1 points: exact for polynomials up to degree 2 * half_width. Near the ends
/// the same number of points is used one-sided.
/// \param columns        N x channels, N >= 2 * half_width + 1
/// \param sample_time_s  of the rows [s]
/// \param derivative     1 or 2
/// \return               N x channels, in units of the columns per s^derivative
/// Throws Error(usage) if an argument is out of range.
[[nodiscard]] Eigen::MatrixXd differentiate(const Eigen::Ref<const Eigen::MatrixXd>& columns, double sample_time_s,
                                            int derivative, int half_width = 3);

}  // namespace deltadyn
