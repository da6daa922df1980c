#include "deltadyn/signal/differentiate.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {

using Eigen::Index;

namespace {

/// Weights w of the polynomial through all points: its `derivative`-th derivative at the point `at` is sum_k w(k) x(k)
/// / h^derivative, for samples at 0 .. points-1 in units of the sample time h.
/// \param at  in samples, e.g. (points - 1)/2 for the centre
Eigen::VectorXd derivative_weights(int points, int derivative, double at) {
  const int degree = points - 1;
  // Scaled to [-1, 1] around the point, the powers stay well conditioned.
  const double scale = std::max(at, points - 1 - at);
  Eigen::MatrixXd powers(points, degree + 1);
  for (int k = 0; k < points; ++k) {
    double power = 1.0;
    for (int j = 0; j <= degree; ++j) {
      powers(k, j) = power;
      power *= (k - at) / scale;
    }
  }
  double factor = 1.0;
  for (int j = 1; j <= derivative; ++j) factor *= j / scale;
  // The coefficient of the wanted power is e' (A'A)^-1 A' x; its weights are the least-norm solution of A' w = e.
  Eigen::VectorXd unit = Eigen::VectorXd::Zero(degree + 1);
  unit(derivative) = factor;
  return dense::least_norm(powers.transpose(), unit);
}

}  // namespace

Eigen::MatrixXd differentiate(const Eigen::Ref<const Eigen::MatrixXd>& columns, double sample_time_s, int derivative,
                              int half_width) {
  if (derivative < 1 || derivative > 2 || half_width < 1 || half_width > 8) {
    throw Error("the derivative must be 1 or 2, the half width 1 to 8", "differentiation", "", ExitCode::usage);
  }
  const int points = 2 * half_width + 1;
  const Index n = columns.rows();
  if (!(sample_time_s > 0) || n < points) {
    throw Error("too few samples, or no positive sample time", "differentiation",
                "give at least " + std::to_string(points) + " samples", ExitCode::usage);
  }
  const double scale = std::pow(sample_time_s, -derivative);
  const auto at = [&](int position) {
    return Eigen::VectorXd(scale * derivative_weights(points, derivative, position));
  };
  const Eigen::VectorXd centre = at(half_width);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(n, columns.cols());
  const Index inner = n - points + 1;
  for (Index c = 0; c < columns.cols(); ++c) {
    for (int k = 0; k < points; ++k)
      result.col(c).segment(half_width, inner) += centre(k) * columns.col(c).segment(k, inner);
  }
  for (int i = 0; i < half_width; ++i) {
    result.row(i) = at(i).transpose() * columns.topRows(points);
    result.row(n - 1 - i) = at(points - 1 - i).transpose() * columns.bottomRows(points);
  }
  return result;
}

}  // namespace deltadyn
