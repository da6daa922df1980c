#include "common_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "deltadyn/runtime/statistics.hpp"
#include "deltadyn/signal/butterworth.hpp"
#include "deltadyn/signal/resample.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
/// Below this share of the grid's step a channel is faster, and must not fold.
constexpr double kFaster = 0.75;
/// The grid holds frequencies up to half its rate; the filter is 3 dB down here and 30 dB at the first that folds back
/// into the lower fifth of the rate, where motions live.
constexpr double kLowPassShare = 0.4;
constexpr double kLongestGap = 2.5;

/// Values on an even grid of the channel's own, filtered without lag.
SampledChannel low_passed(const SampledChannel& series, double step_s, double cutoff_hz) {
  const double span = series.t_s(series.t_s.size() - 1) - series.t_s(0);
  const auto samples = static_cast<Index>(std::floor(span / step_s + 0.5)) + 1;
  SampledChannel even;
  even.t_s =
      Eigen::VectorXd::LinSpaced(samples, series.t_s(0), series.t_s(0) + static_cast<double>(samples - 1) * step_s);
  even.values = zero_phase_filter(resample(series.t_s, series.values, even.t_s), 1.0 / step_s, cutoff_hz);
  return even;
}

}  // namespace

ValueRange range_of(const Eigen::Ref<const Eigen::VectorXd>& values) {
  const auto known = !values.array().isNaN();
  return {known.select(values.array(), HUGE_VAL).minCoeff(), known.select(values.array(), -HUGE_VAL).maxCoeff()};
}

double usual_step_s(const Eigen::Ref<const Eigen::VectorXd>& t_s) {
  std::vector<double> steps;
  for (Index i = 0; i + 1 < t_s.size(); ++i) {
    if (t_s(i + 1) > t_s(i)) steps.push_back(t_s(i + 1) - t_s(i));
  }
  return upper_median(std::move(steps));
}

double mean_rate_hz(const Eigen::Ref<const Eigen::VectorXd>& t_s) {
  const Index n = t_s.size();
  const double span = n < 2 ? 0.0 : t_s(n - 1) - t_s(0);
  return span > 0 ? static_cast<double>(n - 1) / span : 0.0;
}

Eigen::VectorXd onto_grid(const SampledChannel& series, const Eigen::Ref<const Eigen::VectorXd>& grid_s,
                          double& low_pass_hz) {
  const double step_s = usual_step_s(series.t_s), grid_step = usual_step_s(grid_s);
  const Index n = series.t_s.size();
  Eigen::VectorXd result = Eigen::VectorXd::Constant(grid_s.size(), kNan);
  if (n < 4) return result;
  const bool faster = step_s < kFaster * grid_step;
  low_pass_hz = faster ? kLowPassShare / grid_step : 0.0;
  const SampledChannel source = faster ? low_passed(series, step_s, low_pass_hz) : series;
  // Rounding of stamps must not cost the first and last row.
  const double slack = 1e-6 * step_s;
  const double first = series.t_s(0), last = series.t_s(n - 1);
  Index interval = 0;
  std::vector<Index> rows;
  for (Index k = 0; k < grid_s.size(); ++k) {
    const double t = grid_s(k);
    if (t < first - slack || t > last + slack) continue;
    while (interval > 0 && series.t_s(interval) > t) --interval;
    while (interval + 2 < n && series.t_s(interval + 1) <= t) ++interval;
    const bool on_sample =
        std::abs(t - series.t_s(interval)) <= slack || std::abs(t - series.t_s(interval + 1)) <= slack;
    if (on_sample || series.t_s(interval + 1) - series.t_s(interval) <= kLongestGap * step_s) rows.push_back(k);
  }
  result(rows) = resample(source.t_s, source.values, grid_s(rows));
  return result;
}

Index first_of_repeats(const Eigen::Ref<const Eigen::VectorXd>& values, Index factor) {
  std::vector<Index> changes(static_cast<std::size_t>(factor), 0);
  for (Index i = 1; i < values.size(); ++i) {
    if (values(i) != values(i - 1)) ++changes[static_cast<std::size_t>(i % factor)];
  }
  return std::ranges::max_element(changes) - changes.begin();
}

Index unwrap(Eigen::Ref<Eigen::VectorXd> values, double wrap) {
  Index jumps = 0;
  double turns = 0.0, last = kNan;
  for (Index i = 0; i < values.size(); ++i) {
    const double value = values(i);
    if (std::isnan(value)) continue;
    const double around = std::isnan(last) ? 0.0 : std::round((value - last) / wrap);
    if (around != 0.0) {
      ++jumps;
      turns -= around;
    }
    last = value;
    values(i) = value + turns * wrap;
  }
  return jumps;
}

double find_wrap(const Eigen::Ref<const Eigen::VectorXd>& values, double counts) {
  std::vector<double> steps;
  for (Index i = 0; i + 1 < values.size(); ++i) {
    const double step = std::abs(values(i + 1) - values(i));
    if (!std::isnan(step)) steps.push_back(step);
  }
  if (steps.size() < 10) return 0.0;
  const double largest = *std::ranges::max_element(steps);
  const std::size_t most = steps.size() * 98 / 100;
  const double usual = order_statistic(std::move(steps), most);
  // A number that begins again jumps by nearly its whole range, far more than it ever moves in a step.
  if (!(largest > 20.0 * usual)) return 0.0;
  std::vector<double> periods = {2.0 * std::numbers::pi, 360.0};
  if (counts > 0) periods.push_back(counts);
  for (int bits = 8; bits <= 32; ++bits) periods.push_back(std::ldexp(1.0, bits));
  const double range = range_of(values).width();
  for (const double period : periods) {
    if (range > period * (1.0 + 1e-9) || range < 0.9 * period) continue;
    const bool all = std::ranges::all_of(
        steps, [&](double step) { return step <= 5.0 * usual || std::abs(step - period) <= 5.0 * usual; });
    if (all) return period;
  }
  return 0.0;
}

}  // namespace deltadyn
