#include "channel_quality.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "deltadyn/runtime/statistics.hpp"

#include "sample_stretches.hpp"

namespace deltadyn::checks {
namespace {

using Eigen::Index;

constexpr Index kStretch = 512;

/// Fourth differences see white noise and hardly a motion; their mean size without the largest hundredth is robust.
double white_noise(const Eigen::Ref<const Eigen::VectorXd>& x, const std::vector<Stretch>& stretches) {
  std::vector<double> sizes;
  for (const auto& [begin, end] : stretches) {
    for (Index i = begin + 2; i + 2 < end; ++i) {
      const double size = std::abs(x(i - 2) - 4.0 * x(i - 1) + 6.0 * x(i) - 4.0 * x(i + 1) + x(i + 2));
      if (std::isfinite(size)) sizes.push_back(size);
    }
  }
  return std_of_sizes(std::move(sizes)) / std::sqrt(70.0);  // 1 + 16 + 36 + 16 + 1
}

/// Share of the changes that are whole multiples of the smallest one.
double share_on_lattice(const std::vector<double>& changes, double smallest) {
  constexpr double kOff = 0.05;  // decimal rounding of the file moves a change by less
  double on = 0, judged = 0;
  for (const double change : changes) {
    const double multiple = change / smallest;
    if (multiple > 200.0) continue;  // the error of the step itself, times the multiple, would decide
    judged += 1.0;
    if (std::abs(multiple - std::round(multiple)) < kOff) on += 1.0;
  }
  return judged > 0 ? on / judged : 0.0;
}

}  // namespace

ChannelQuality measure_channel(const Eigen::Ref<const Eigen::VectorXd>& values) {
  ChannelQuality out;
  const auto stretches = sample_stretches(values.size(), kStretch);
  const auto known = values.array().isFinite();
  const double lowest = known.any() ? known.select(values.array(), HUGE_VAL).minCoeff() : 0.0;
  const double highest = known.any() ? known.select(values.array(), -HUGE_VAL).maxCoeff() : 0.0;
  double rows = 0, repeats = 0;
  out.range = highest - lowest;
  // Smaller changes are rounding of decimal numbers, not counts of an encoder.
  const double rounding = 1e-12 * std::max(std::abs(lowest), std::abs(highest));
  std::vector<double> changes, seen;
  for (const auto& [begin, end] : stretches) {
    for (Index i = begin + 1; i < end; ++i) {
      const double change = std::abs(values(i) - values(i - 1));
      if (!std::isfinite(change)) continue;
      seen.push_back(values(i));
      rows += 1.0;
      if (change > rounding) {
        changes.push_back(change);
      } else {
        repeats += 1.0;
      }
    }
  }
  out.repeat_share = rows > 0 ? repeats / rows : 0.0;
  out.travel = quantile(seen, 0.999) - quantile(seen, 0.001);
  if (!changes.empty()) {
    out.smallest = quantile(changes, 0.005);  // a few smaller ones may come from spoilt rows
    if (share_on_lattice(changes, out.smallest) > 0.95) out.step = out.smallest;
  }
  // A quantised channel at rest shows no scatter, and still is not known better than to its step.
  out.noise = std::max(white_noise(values, stretches), out.step / std::sqrt(12.0));
  return out;
}

}  // namespace deltadyn::checks
