#pragma once

/// \file
/// Order statistics and root mean squares, each defined once. Values must not be NaN.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace deltadyn {

/// Standard deviation of normal noise over the median of its absolute values.
inline constexpr double kMedianToSigma = 1.4826;

/// The value at place `rank`, from 0, when all are sorted. \param rank  below the number of values
template <class Value>
[[nodiscard]] Value order_statistic(std::vector<Value> values, std::size_t rank) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// Value that a share of all does not exceed, always one of the values: the one at place floor(share (n - 1)) when
/// sorted; 0 for none.
/// \param share  0 (the least value) to 1 (the largest)
template <class Value>
[[nodiscard]] Value quantile(std::vector<Value> values, double share) {
  if (values.empty()) return Value{};
  const auto rank = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  return order_statistic(std::move(values), rank);
}

/// The middle value; of an even number the lower one of the two in the middle, so that it is always one of the values.
/// 0 for none.
template <class Value>
[[nodiscard]] Value lower_median(std::vector<Value> values) {
  return quantile(std::move(values), 0.5);
}

/// The middle value; of an even number the upper one of the two in the middle, so that it is always one of the values.
/// 0 for none.
template <class Value>
[[nodiscard]] Value upper_median(std::vector<Value> values) {
  if (values.empty()) return Value{};
  const std::size_t middle = values.size() / 2;
  return order_statistic(std::move(values), middle);
}

/// Standard deviation of normal noise from its absolute values: their mean without the largest hundredth. Robust like a
/// median, but not itself a multiple of an encoder's count. 0 for none.
[[nodiscard]] inline double std_of_sizes(std::vector<double> sizes) {
  if (sizes.empty()) return 0.0;
  constexpr double kKept = 0.99;
  constexpr double kMeanOfKept = 0.7767;  // of a standard normal variable
  const auto end = sizes.begin() + static_cast<std::ptrdiff_t>(std::ceil(kKept * static_cast<double>(sizes.size())));
  std::nth_element(sizes.begin(), end - 1, sizes.end());
  return std::accumulate(sizes.begin(), end, 0.0) / static_cast<double>(end - sizes.begin()) / kMeanOfKept;
}

/// Root mean square from a sum of squares; 0 for no values. \param count  of the values; may be a sum of weights
[[nodiscard]] inline double root_mean_square(double sum_of_squares, double count) {
  return count > 0 ? std::sqrt(sum_of_squares / count) : 0.0;
}

/// Root mean square; 0 for no values.
template <class Derived>
[[nodiscard]] double root_mean_square(const Eigen::MatrixBase<Derived>& values) {
  return root_mean_square(values.squaredNorm(), static_cast<double>(values.size()));
}

/// Root mean square of the values that count; 0 for none. \param counts  of the length of `values`
template <class Derived>
[[nodiscard]] double root_mean_square(const Eigen::MatrixBase<Derived>& values,
                                      const Eigen::Array<bool, Eigen::Dynamic, 1>& counts) {
  return root_mean_square(counts.select(values.array(), 0.0).square().sum(), static_cast<double>(counts.count()));
}

}  // namespace deltadyn
