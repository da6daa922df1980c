#include "deltadyn/trajectory/fourier_series.hpp"

#include <cmath>
#include <numbers>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {

using Eigen::Index;

Eigen::MatrixXd fourier_basis(const Eigen::Ref<const Eigen::VectorXd>& phases, int harmonics, int derivative) {
  Eigen::MatrixXd basis(phases.size(), 1 + 2 * harmonics);
  basis.col(0).setConstant(derivative == 0 ? 1.0 : 0.0);
  for (int k = 1; k <= harmonics; ++k) {
    const double factor = std::pow(k, derivative);
    // d^n sin(x) = sin(x + n pi/2), without the rounding of pi/2.
    for (Index i = 0; i < phases.size(); ++i) {
      const double s = std::sin(k * phases(i)), c = std::cos(k * phases(i));
      const double sines[] = {s, c, -s, -c}, cosines[] = {c, -s, -c, s};
      basis(i, 2 * k - 1) = factor * sines[derivative % 4];
      basis(i, 2 * k) = factor * cosines[derivative % 4];
    }
  }
  return basis;
}

Eigen::VectorXd even_phases(Index n) {
  Eigen::VectorXd phases(n);
  for (Index i = 0; i < n; ++i) phases(i) = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
  return phases;
}

Eigen::MatrixXd FourierSeries::at_phases(const Eigen::Ref<const Eigen::VectorXd>& phases, int derivative) const {
  return std::pow(omega(), derivative) * (fourier_basis(phases, harmonics(), derivative) * coefficients);
}

TaskState FourierSeries::state(double phase, double rate, double rate_d) const {
  const Eigen::VectorXd at = Eigen::VectorXd::Constant(1, phase);
  const auto derivative = [&](int n) -> Eigen::VectorXd {
    return (fourier_basis(at, harmonics(), n) * coefficients).row(0).transpose();
  };
  const Eigen::VectorXd first = derivative(1);
  return {derivative(0), rate * first, rate * rate * derivative(2) + rate_d * first};
}

FourierSeries FourierSeries::scaled(const Eigen::Ref<const Eigen::VectorXd>& centre, double factor) const {
  FourierSeries result = *this;
  result.coefficients *= factor;
  result.coefficients.row(0) += (1 - factor) * centre.transpose();
  return result;
}

void FourierSeries::validate(const std::string& where) const {
  if (!(base_frequency_hz > 0) || !std::isfinite(base_frequency_hz))
    throw Error("the base frequency is not a positive number", where, "give a frequency in Hz, e.g. 0.5");
  if (coefficients.rows() < 3 || coefficients.rows() % 2 == 0 || coefficients.cols() < 1)
    throw Error("the coefficients are not b_0, a_1, b_1, a_2, b_2, ... for every coordinate", where, "");
  if (!coefficients.allFinite()) throw Error("a coefficient is not finite", where, "");
}

}  // namespace deltadyn
