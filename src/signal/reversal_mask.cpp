#include "deltadyn/signal/reversal_mask.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/statistics.hpp"
#include "deltadyn/signal/butterworth.hpp"

namespace deltadyn {

using Eigen::Index;

std::vector<char> reversal_mask(const Eigen::Ref<const Eigen::VectorXd>& rate, double threshold, Index grow) {
  if (!(threshold >= 0) || grow < 0) {
    throw Error("threshold and width must not be negative", "reversal mask", "", ExitCode::usage);
  }
  const Index n = rate.size();
  std::vector<char> mask(static_cast<std::size_t>(n), 0);
  Index marked_to = 0;  // everything before is decided
  const auto mark = [&](Index from, Index to) {
    from = std::max(from - grow, marked_to);
    to = std::min(n, to + grow);
    for (Index i = from; i < to; ++i) mask[static_cast<std::size_t>(i)] = 1;
    marked_to = std::max(marked_to, to);
  };
  for (Index i = 0; i < n; ++i) {
    if (std::abs(rate(i)) < threshold) mark(i, i + 1);
    // A fast reversal may jump over the band.
    if (i > 0 && (rate(i) > 0) != (rate(i - 1) > 0)) mark(i - 1, i + 1);
  }
  return mask;
}

double position_noise(const Eigen::Ref<const Eigen::VectorXd>& position) {
  const Index n = position.size();
  if (n < 5) return 0.0;
  std::vector<double> sizes;
  double resolution = 0.0;
  const double largest = position.cwiseAbs().maxCoeff();
  for (Index i = 2; i + 2 < n; ++i) {
    sizes.push_back(std::abs(position(i - 2) - 4.0 * position(i - 1) + 6.0 * position(i) - 4.0 * position(i + 1) +
                             position(i + 2)));
    const double step = std::abs(position(i) - position(i - 1));
    // Smaller steps are rounding of the decimal numbers, not counts of the encoder.
    if (step > 1e-12 * largest && (resolution == 0.0 || step < resolution)) resolution = step;
  }
  const double robust = std_of_sizes(std::move(sizes)) / std::sqrt(70.0);  // 1 + 16 + 36 + 16 + 1
  return robust > 0 ? robust : resolution / std::sqrt(12.0);
}

double derivative_noise(double position_noise, double sample_rate_hz, double cutoff_hz, int order, int derivative) {
  const auto sections =
      butterworth_low_pass(sample_rate_hz, single_pass_cutoff_hz(sample_rate_hz, cutoff_hz, order), order);
  // Parseval: mean over the frequencies of (omega^d gain)^2. Beyond some multiples of the cut-off nothing is left.
  constexpr int kSteps = 4000;
  const double highest_hz = std::min(0.5 * sample_rate_hz, 8.0 * cutoff_hz);
  double sum = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double frequency = (k + 0.5) * highest_hz / kSteps;
    const double gain =
        zero_phase_gain(sections, sample_rate_hz, frequency) * std::pow(2.0 * std::numbers::pi * frequency, derivative);
    sum += gain * gain;
  }
  return position_noise * std::sqrt(sum / kSteps * highest_hz / (0.5 * sample_rate_hz));
}

}  // namespace deltadyn
