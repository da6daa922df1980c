#include "unknown_torque.hpp"

#include <algorithm>
#include <cmath>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/statistics.hpp"

namespace deltadyn {

namespace {

// Squared size of a direction that can be told from rounding, in units of the largest
constexpr double kFinest = 1e-7;
constexpr double kEarlyOrLate_s = 0.008;  // by which a recorded torque may stand before or behind the motion
constexpr Index kPerRow = 4;              // unknowns a row of the log: the low pass leaves no more than about one

/// \param first, end  samples of the stretch
UnknownTorque through_low_pass(const PreparedLog& log, Index first, Index end, double size) {
  UnknownTorque out;
  const Index reach = log.low_pass ? log.low_pass->half_width() : 0;
  // Rows whose filter covers a sample of the stretch.
  const Index from = std::max<Index>(0, (first - reach - log.first + log.stride - 1) / log.stride);
  const Index to = std::min(log.rows - 1, (end - 1 + reach - log.first) / log.stride);
  if (end - 1 + reach < log.first || to < from) return out;
  const Index step = log.low_pass ? std::max<Index>(1, log.stride / kPerRow) : 1;
  const Index unknowns = (end - first + step - 1) / step;
  MatrixXd response = MatrixXd::Zero(to - from + 1, unknowns);
  for (Index row = from; row <= to; ++row) {
    const Index centre = sample_of_row(log, row);
    for (Index k = 0; k < unknowns; ++k) {
      const Index tap = std::min(first + k * step, end - 1) - centre + reach;
      if (tap < 0 || tap > 2 * reach) continue;
      response(row - from, k) = size * (log.low_pass ? static_cast<double>(step) * log.low_pass->taps()(tap) : 1.0);
    }
  }
  const dense::Spectrum spectrum = dense::spectrum(response * response.transpose());
  const VectorXd& squares = spectrum.values;  // rising
  Index kept = 0;
  while (kept < squares.size() && squares(squares.size() - 1 - kept) > kFinest * squares(squares.size() - 1)) ++kept;
  out.first = from;
  out.directions = spectrum.vectors.rightCols(kept) * squares.tail(kept).cwiseSqrt().asDiagonal();
  return out;
}

}  // namespace

std::vector<UnknownTorque> unknown_torque(const PreparedLog& log, Index drive, RowMask& present) {
  std::vector<UnknownTorque> out;
  const auto marked = log.reversal.col(drive);
  const Index samples = marked.size();
  const Index reach = log.low_pass ? log.low_pass->half_width() : 0;
  const double size = root_mean_square(log.tau.col(drive));
  const auto early_or_late = static_cast<Index>(std::lround(kEarlyOrLate_s * log.rate_hz));
  const auto add = [&](Index first, Index end) {
    UnknownTorque one = through_low_pass(log, first, end, size);
    if (one.directions.cols() > 0) out.push_back(std::move(one));
  };
  for (Index first = 0; first < samples; ++first) {
    if (!marked(first)) continue;
    Index end = first;
    while (end < samples && marked(end)) ++end;
    const Index next = end;
    first = std::max<Index>(0, first - early_or_late);
    end = std::min(samples, end + early_or_late);
    if (end - first <= 6 * reach + 1) {
      add(first, end);
    } else {
      // Only the ends of a long stretch reach rows that know anything.
      add(first, first + 3 * reach);
      add(end - 3 * reach, end);
      for (Index row = 0; row < log.rows; ++row) {
        const Index centre = sample_of_row(log, row);
        if (centre >= first + reach && centre < end - reach) present(row) = false;
      }
    }
    first = next;
  }
  return out;
}

}  // namespace deltadyn
