#include "deltadyn/signal/differentiate.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {

using Eigen::Index;

Eigen::VectorXd derivative_weights(int points, int degree, int derivative, double at) {
  if (points < 2 || points > 4001 || degree < 0 || degree >= points || degree > 20 || derivative < 0 ||
      derivative > degree) {
    throw Error("points, degree and derivative of the polynomial do not fit together", "differentiation",
                "0 <= derivative <= degree < points, degree at most 20", ExitCode::usage);
  }
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

Eigen::MatrixXd savitzky_golay(const Eigen::Ref<const Eigen::MatrixXd>& columns, double sample_time_s, int derivative,
                               int half_width, int degree) {
  const int points = 2 * half_width + 1;
  const Index n = columns.rows();
  if (!(sample_time_s > 0) || half_width < 1 || n < points) {
    throw Error("too few samples, or no positive sample time", "differentiation",
                "give at least " + std::to_string(points) + " samples", ExitCode::usage);
  }
  const double scale = std::pow(sample_time_s, -derivative);
  const auto at = [&](int position) {
    return Eigen::VectorXd(scale * derivative_weights(points, degree, derivative, position));
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

Eigen::MatrixXd differentiate(const Eigen::Ref<const Eigen::MatrixXd>& columns, double sample_time_s, int derivative,
                              int half_width) {
  if (derivative < 1 || derivative > 2 || half_width < 1 || half_width > 8) {
    throw Error("the derivative must be 1 or 2, the half width 1 to 8", "differentiation", "", ExitCode::usage);
  }
  return savitzky_golay(columns, sample_time_s, derivative, half_width, 2 * half_width);
}

}  // namespace deltadyn
