#include "deltadyn/signal/torque_timing_mend.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace deltadyn {

namespace {

using Eigen::Index;

// Samples of the windowed sinc on either side; flat to 0.9 of half the sample rate
constexpr Index kHalfWidth = 24;
constexpr double kMostLift = 4.0;      // of noise by the inverse of a low pass
constexpr double kLowestBand_hz = 80;  // the inverse reaches at least so far, whatever it lifts: the band of a motion

/// Low pass with its edge at `cut` (share of the sample rate, at most 0.5), and its slope, u samples from the centre.
void windowed_sinc(double cut, double width, double u, double& value, double& slope) {
  if (std::abs(u) >= width) {
    value = slope = 0;
    return;
  }
  constexpr double kPi = std::numbers::pi;
  const double x = 2 * kPi * cut * u;
  const double sinc = std::abs(x) < 1e-4 ? 1 - x * x / 6 : std::sin(x) / x;
  const double sinc_slope = std::abs(x) < 1e-4 ? -x / 3 : (std::cos(x) - sinc) / x;
  // Blackman's window
  const double a = kPi * u / width;
  const double window = 0.42 + 0.5 * std::cos(a) + 0.08 * std::cos(2 * a);
  const double window_slope = -(kPi / width) * (0.5 * std::sin(a) + 0.16 * std::sin(2 * a));
  value = 2 * cut * sinc * window;
  slope = 2 * cut * (2 * kPi * cut * sinc_slope * window + sinc * window_slope);
}

}  // namespace

Eigen::VectorXd first_order_low_pass(const Eigen::Ref<const Eigen::VectorXd>& x, double step_s, double T_s) {
  Eigen::VectorXd y(x.size());
  if (x.size() == 0) return y;
  const double a = std::exp(-step_s / T_s);
  const double ratio = T_s / step_s;
  // Over one step the input runs from x(k-1) to x(k) in a straight line.
  const double now = 1 - ratio * (1 - a), before = ratio * (1 - a) - a;
  y(0) = x(0);
  for (Index k = 1; k < x.size(); ++k) y(k) = a * y(k - 1) + now * x(k) + before * x(k - 1);
  return y;
}

Eigen::VectorXd mend_timing(const Eigen::Ref<const Eigen::VectorXd>& y, double step_s, double delay_s, double lag_s) {
  Eigen::VectorXd x = lag_s < 0 ? first_order_low_pass(y, step_s, -lag_s) : Eigen::VectorXd(y);
  const double lag = std::max(0.0, lag_s) / step_s;  // in samples
  if (delay_s == 0 && lag == 0) return x;
  double cut = 0.5;
  if (lag > 0) {
    const double band_hz =
        std::max(kLowestBand_hz, std::sqrt(kMostLift * kMostLift - 1) / (2 * std::numbers::pi * lag_s));
    cut = std::min(0.4, band_hz * step_s);
  }
  const double width = static_cast<double>(kHalfWidth) * std::max(1.0, 0.25 / cut);
  const double shift = delay_s / step_s;
  const auto middle = static_cast<Index>(std::floor(shift));
  const auto reach = static_cast<Index>(std::ceil(width));
  Eigen::VectorXd weight(2 * reach + 2);
  double sum = 0;
  for (Index k = 0; k < weight.size(); ++k) {
    double value = 0, slope = 0;
    windowed_sinc(cut, width, shift - static_cast<double>(middle + k - reach), value, slope);
    weight(k) = value + lag * slope;
    sum += value;
  }
  weight /= sum;
  const Index n = x.size();
  Eigen::VectorXd out(n);
  for (Index k = 0; k < n; ++k) {
    const Index from = k + middle - reach;
    if (from >= 0 && from + weight.size() <= n) {
      out(k) = weight.dot(x.segment(from, weight.size()));
      continue;
    }
    double value = 0;
    for (Index i = 0; i < weight.size(); ++i) value += weight(i) * x(std::clamp<Index>(from + i, 0, n - 1));
    out(k) = value;
  }
  return out;
}

Eigen::VectorXd mend_delays(const Eigen::Ref<const Eigen::VectorXd>& y, double step_s,
                            const Eigen::Ref<const Eigen::VectorXd>& delay_s) {
  const Index n = y.size();
  Eigen::VectorXd out(n);
  for (Index k = 0; k < n; ++k) {
    const double at = static_cast<double>(k) + delay_s(k) / step_s;  // in samples
    const auto middle = static_cast<Index>(std::floor(at));
    double sum = 0, weights = 0;
    for (Index i = middle - kHalfWidth; i <= middle + kHalfWidth + 1; ++i) {
      double value = 0, slope = 0;
      windowed_sinc(0.5, static_cast<double>(kHalfWidth), at - static_cast<double>(i), value, slope);
      sum += value * y(std::clamp<Index>(i, 0, n - 1));
      weights += value;
    }
    out(k) = sum / weights;
  }
  return out;
}

}  // namespace deltadyn
