#pragma once

/// \file
/// Derivatives of evenly sampled signals.

#include <Eigen/Core>

namespace deltadyn {

/// Weights w of a polynomial fit: the `derivative`-th derivative at the point `at` is sum_k w(k) x(k) / h^derivative,
/// for samples at 0 .. points-1 in units of the sample time h. Least squares if degree < points - 1 (Savitzky-Golay),
/// interpolation if equal.
/// \param at          in samples, e.g. (points - 1)/2 for the centre
/// \param degree      of the polynomial, at least `derivative`, below `points`
/// Throws Error(usage) if an argument is out of range.
[[nodiscard]] Eigen::VectorXd derivative_weights(int points, int degree, int derivative, double at);

/// Central differences of 2 * half_width + 1 points: exact for polynomials up to degree 2 * half_width. Near the ends
/// the same number of points is used one-sided.
/// \param columns        N x channels, N >= 2 * half_width + 1
/// \param sample_time_s  of the rows [s]
/// \param derivative     1 or 2
/// \return               N x channels, in units of the columns per s^derivative
/// Throws Error(usage) if an argument is out of range.
[[nodiscard]] Eigen::MatrixXd differentiate(const Eigen::Ref<const Eigen::MatrixXd>& columns, double sample_time_s,
                                            int derivative, int half_width = 3);

/// Savitzky-Golay: value (derivative 0) or derivative of the least-squares polynomial through 2 * half_width + 1
/// points. Exact for polynomials up to `degree`; the ends use the polynomial of the first or last points. Arguments as
/// differentiate(); derivative 0 to degree.
[[nodiscard]] Eigen::MatrixXd savitzky_golay(const Eigen::Ref<const Eigen::MatrixXd>& columns, double sample_time_s,
                                             int derivative, int half_width, int degree);

}  // namespace deltadyn
