#include "deltadyn/signal/time_grid.hpp"

#include <algorithm>
#include <cmath>

#include "deltadyn/runtime/statistics.hpp"

namespace deltadyn {
namespace {

/// Straight line through (index, stamp).
void fit_line(const Eigen::Ref<const Eigen::VectorXd>& t_s, TimeGrid& grid) {
  const Eigen::Index n = t_s.size();
  double mean_index = 0;
  for (const Eigen::Index k : grid.index) mean_index += static_cast<double>(k) / static_cast<double>(n);
  const double mean_time = t_s.mean();
  double numerator = 0, denominator = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double k = static_cast<double>(grid.index[static_cast<std::size_t>(i)]) - mean_index;
    numerator += k * (t_s(i) - mean_time);
    denominator += k * k;
  }
  grid.step_s = numerator / denominator;
  grid.start_s = mean_time - mean_index * grid.step_s;
  grid.jitter = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double expected = grid.start_s + static_cast<double>(grid.index[static_cast<std::size_t>(i)]) * grid.step_s;
    const double distance = std::abs(t_s(i) - expected) / grid.step_s;
    if (distance > grid.jitter) {
      grid.jitter = distance;
      grid.worst = i;
    }
  }
}

}  // namespace

TimeGrid fit_time_grid(const Eigen::Ref<const Eigen::VectorXd>& t_s) {
  const Eigen::Index n = t_s.size();
  TimeGrid whole;
  whole.index.resize(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) whole.index[static_cast<std::size_t>(i)] = i;
  fit_line(t_s, whole);

  std::vector<double> steps(static_cast<std::size_t>(n - 1));
  for (Eigen::Index i = 0; i + 1 < n; ++i) steps[static_cast<std::size_t>(i)] = t_s(i + 1) - t_s(i);
  const double usual_step = upper_median(std::move(steps));

  TimeGrid gapped;
  gapped.index.resize(static_cast<std::size_t>(n));
  Eigen::Index k = 0;
  gapped.index[0] = 0;
  for (Eigen::Index i = 1; i < n; ++i) {
    k += std::max<Eigen::Index>(1, static_cast<Eigen::Index>(std::lround((t_s(i) - t_s(i - 1)) / usual_step)));
    gapped.index[static_cast<std::size_t>(i)] = k;
  }
  if (k == n - 1) return whole;
  fit_line(t_s, gapped);
  // Strong jitter alone makes steps that look like gaps, but then the grid with gaps does not fit either.
  return gapped.jitter < 0.5 * whole.jitter ? gapped : whole;
}

}  // namespace deltadyn
