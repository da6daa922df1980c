#pragma once

/// \file
/// Which rows of a channel of any length its statistics are taken from: evenly spread stretches.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace deltadyn::checks {

/// A stretch of consecutive rows [first, second).
using Stretch = std::pair<Eigen::Index, Eigen::Index>;

/// Stretches of `length` rows that tell as much about a channel as all of its rows: all rows of a short log, evenly
/// spread ones of a long log, so that the statistics of a long log cost no more than those of a short one.
inline std::vector<Stretch> sample_stretches(Eigen::Index rows, Eigen::Index length) {
  constexpr Eigen::Index kEnoughRows = 40000;
  std::vector<Stretch> stretches;
  const Eigen::Index all = std::max<Eigen::Index>(1, rows / length);
  const Eigen::Index wanted = std::min(all, std::max<Eigen::Index>(1, kEnoughRows / length));
  for (Eigen::Index k = 0; k < wanted; ++k) {
    const Eigen::Index begin = k * all / wanted * length;
    // The last stretch of a log that is used whole takes what is left over.
    const Eigen::Index end = wanted == all && k + 1 == all ? rows : std::min(rows, begin + length);
    stretches.emplace_back(begin, end);
  }
  return stretches;
}

/// Calls each(begin, end) for the runs of equal values.
template <class Values, class Each>
void for_each_run(const Values& values, Each each) {
  for (Eigen::Index begin = 0, end = 0; begin < values.size(); begin = end) {
    end = begin + 1;
    while (end < values.size() && values(end) == values(begin)) ++end;
    each(begin, end);
  }
}

/// Calls each(begin, end) for the runs of missing numbers.
template <class Values, class Each>
void for_each_gap(const Values& values, Each each) {
  for (Eigen::Index begin = 0; begin < values.size(); ++begin) {
    Eigen::Index end = begin;
    while (end < values.size() && !std::isfinite(values(end))) ++end;
    if (end == begin) continue;
    each(begin, end);
    begin = end;
  }
}

/// Steps in time between rows of one recording.
inline std::vector<double> steps_of(const Eigen::VectorXd& t_s) {
  std::vector<double> steps;
  for (const auto& [begin, end] : sample_stretches(t_s.size(), 256)) {
    for (Eigen::Index i = begin + 1; i < end; ++i) {
      if (t_s(i) > t_s(i - 1)) steps.push_back(t_s(i) - t_s(i - 1));
    }
  }
  return steps;
}

}  // namespace deltadyn::checks
