#include "deltadyn/report/thinning.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <unordered_set>

namespace deltadyn {
namespace {

using Index = Eigen::Index;
constexpr double kBreak = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kMaxPoints = 1500;      // an SVG point takes about 80 bytes,
constexpr std::size_t kMaxPathPoints = 6000;  // a vertex of a line about 13

/// Positions in pixels; NaN where the sample cannot be drawn.
struct Pixels {
  Eigen::VectorXd x, y;
  [[nodiscard]] bool drawable(Index i) const { return std::isfinite(x(i)) && std::isfinite(y(i)); }
};

Pixels to_pixels(const Series& series, const PlotFrame& frame) {
  Pixels pixels{Eigen::VectorXd(series.x.size()), Eigen::VectorXd(series.x.size())};
  for (Index i = 0; i < series.x.size(); ++i) {
    pixels.x(i) = frame.x.fraction_of(series.x(i), frame.log_x) * frame.columns;
    pixels.y(i) = frame.y.fraction_of(series.y(i), frame.log_y) * frame.rows;
  }
  return pixels;
}

Series pick(const Series& series, const Pixels& pixels, const std::vector<Index>& kept) {
  Series result = series;
  const auto n = static_cast<Index>(kept.size());
  const bool bars = series.y_error.size() > 0;
  result.x.resize(n);
  result.y.resize(n);
  result.y_error.resize(bars ? n : 0);
  for (Index k = 0; k < n; ++k) {
    const Index i = kept[static_cast<std::size_t>(k)];
    const bool drawable = pixels.drawable(i);
    result.x(k) = drawable ? series.x(i) : kBreak;
    result.y(k) = drawable ? series.y(i) : kBreak;
    if (bars) result.y_error(k) = drawable ? series.y_error(i) : kBreak;
  }
  return result;
}

bool x_never_decreases(const Pixels& pixels) {
  double last = -std::numeric_limits<double>::infinity();
  for (Index i = 0; i < pixels.x.size(); ++i) {
    if (!std::isfinite(pixels.x(i))) continue;
    if (pixels.x(i) < last) return false;
    last = pixels.x(i);
  }
  return true;
}

/// Pixel column; all that lies left or right of the frame shares one column on each side.
Index column_of(double x_pixel, const PlotFrame& frame) {
  return static_cast<Index>(std::clamp(std::floor(x_pixel), -1.0, static_cast<double>(frame.columns)));
}

/// Smallest and largest sample of each column in the order they came, and at most two gaps a column.
std::vector<Index> column_extremes(const Pixels& pixels, const PlotFrame& frame) {
  std::vector<Index> kept;
  const Index n = pixels.x.size();
  Index i = 0;
  while (i < n) {
    // Samples that cannot be drawn have no column of their own: they belong to the one they interrupt.
    const Index begin = i;
    Index column = 0, smallest = -1, largest = -1, gap = -1, last = -1;
    for (; i < n; ++i) {
      if (!pixels.drawable(i)) {
        gap = i;
        continue;
      }
      const Index here = column_of(pixels.x(i), frame);
      if (smallest < 0) {
        column = here;
        smallest = largest = i;
      } else if (here != column) {
        break;
      }
      if (pixels.y(i) < pixels.y(smallest)) smallest = i;
      if (pixels.y(i) > pixels.y(largest)) largest = i;
      last = i;
    }
    if (!pixels.drawable(begin)) kept.push_back(begin);
    if (smallest >= 0) {
      kept.push_back(std::min(smallest, largest));
      if (smallest != largest) kept.push_back(std::max(smallest, largest));
      if (gap > begin) {  // the line goes on after the gap with the column's last sample
        if (gap > kept.back() || last > kept.back()) kept.push_back(gap);
        if (last > gap) kept.push_back(last);
      }
    }
  }
  if (n > 0 && (kept.empty() || kept.back() != n - 1)) kept.push_back(n - 1);
  return kept;
}

/// Samples of a curve that runs back and forth: each at least \p step pixels from the one kept before.
std::vector<Index> moved_by(const Pixels& pixels, double step) {
  std::vector<Index> kept;
  for (Index i = 0; i < pixels.x.size(); ++i) {
    if (kept.empty() || i + 1 == pixels.x.size()) {
      kept.push_back(i);
      continue;
    }
    const Index before = kept.back();
    if (pixels.drawable(i) != pixels.drawable(before)) {
      kept.push_back(i);
    } else if (pixels.drawable(i) &&
               std::max(std::abs(pixels.x(i) - pixels.x(before)), std::abs(pixels.y(i) - pixels.y(before))) >= step) {
      kept.push_back(i);
    }
  }
  return kept;
}

/// One point a cell, and the lowest and highest of each column (with its bar).
std::vector<Index> one_a_cell(const Series& series, const Pixels& pixels, const PlotFrame& frame, double cell) {
  std::unordered_set<std::int64_t> taken;
  std::map<std::int64_t, std::array<Index, 2>> extremes;
  std::vector<Index> kept;
  const auto reach = [&](Index i, double sign) {
    return sign * series.y(i) +
           (series.y_error.size() > 0 && std::isfinite(series.y_error(i)) ? series.y_error(i) : 0.0);
  };
  for (Index i = 0; i < pixels.x.size(); ++i) {
    if (!pixels.drawable(i) || pixels.x(i) < 0.0 || pixels.x(i) > frame.columns) continue;
    const auto column = static_cast<std::int64_t>(std::floor(pixels.x(i) / cell));
    const auto row = static_cast<std::int64_t>(std::floor(std::clamp(pixels.y(i), -1.0, frame.rows + 1.0) / cell));
    if (taken.insert(column * 100'000 + row).second) kept.push_back(i);
    const auto [entry, is_new] = extremes.try_emplace(column, std::array<Index, 2>{i, i});
    if (is_new) continue;
    if (reach(i, -1.0) > reach(entry->second[0], -1.0)) entry->second[0] = i;
    if (reach(i, 1.0) > reach(entry->second[1], 1.0)) entry->second[1] = i;
  }
  for (const auto& [column, ends] : extremes) kept.insert(kept.end(), ends.begin(), ends.end());
  std::ranges::sort(kept);
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  return kept;
}

}  // namespace

Series thin(const Series& series, const PlotFrame& frame) {
  const Pixels pixels = to_pixels(series, frame);
  const auto n = static_cast<std::size_t>(series.x.size());
  std::vector<Index> kept(n);
  std::iota(kept.begin(), kept.end(), Index{0});

  if (series.style == SeriesStyle::points || series.style == SeriesStyle::errorbars) {
    for (double cell = 1.0; kept.size() > kMaxPoints; cell *= 1.5) kept = one_a_cell(series, pixels, frame, cell);
  } else if (x_never_decreases(pixels)) {
    if (n > 2 * static_cast<std::size_t>(frame.columns)) kept = column_extremes(pixels, frame);
  } else {
    for (double step = 1.0; kept.size() > kMaxPathPoints && step < frame.columns; step *= 1.5)
      kept = moved_by(pixels, step);
  }
  return pick(series, pixels, kept);
}

}  // namespace deltadyn
