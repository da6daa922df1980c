#include "deltadyn/identification/residual_structure.hpp"

#include <algorithm>
#include <numeric>

#include "least_squares.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;

constexpr Index kIntervals = 24;       // fine enough for the shape of a friction curve on both sides of zero
constexpr Index kShifts = 199;         // the smallest p-value is 1/200
constexpr Index kRowsPerInterval = 4;  // below that the means are noise

/// Interval of each row; all intervals hold the same number of rows, so that rare speeds count as little as they occur.
std::vector<Index> intervals_of(const Eigen::VectorXd& coordinate) {
  const Index n = coordinate.size();
  std::vector<Index> order(static_cast<std::size_t>(n)), interval(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return coordinate(a) < coordinate(b); });
  for (Index rank = 0; rank < n; ++rank)
    interval[static_cast<std::size_t>(order[static_cast<std::size_t>(rank)])] = rank * kIntervals / n;
  return interval;
}

/// Sum over the intervals of count x mean^2, of the residual moved on by `shift` rows.
double explained(const std::vector<Index>& interval, const Eigen::VectorXd& residual, Index shift) {
  Eigen::Array<double, kIntervals, 1> sum = Eigen::Array<double, kIntervals, 1>::Zero(), count = sum;
  const Index n = residual.size();
  for (Index row = 0; row < n; ++row) {
    const Index k = interval[static_cast<std::size_t>(row)];
    sum(k) += residual(row + shift < n ? row + shift : row + shift - n);
    count(k) += 1;
  }
  return (sum.square() / count.max(1.0)).sum();
}

}  // namespace

DependenceOnMotion dependence_on(const Eigen::VectorXd& coordinate, const Eigen::VectorXd& residual) {
  DependenceOnMotion result;
  const Index n = residual.size();
  const double total = residual.squaredNorm();
  if (n < kIntervals * kRowsPerInterval || coordinate.size() != n || !(total > 0)) return result;
  const std::vector<Index> interval = intervals_of(coordinate);
  const double found = explained(interval, residual, 0);
  double by_chance = 0;
  Index as_good = 0;
  for (Index k = 1; k <= kShifts; ++k) {
    const double shifted = explained(interval, residual, k * n / (kShifts + 1));
    by_chance += shifted / static_cast<double>(kShifts);
    as_good += shifted >= found ? 1 : 0;
  }
  result.share = total > by_chance ? std::clamp((found - by_chance) / (total - by_chance), 0.0, 1.0) : 0.0;
  result.p_value = static_cast<double>(as_good + 1) / static_cast<double>(kShifts + 1);
  return result;
}

std::vector<ResidualStructure> residual_structure(const Validation& validation) {
  std::vector<ResidualStructure> result(validation.drives.size());
  for (std::size_t j = 0; j < result.size(); ++j) {
    const auto drive = static_cast<int>(j);
    std::vector<double> residual, q, qd, qdd;
    double weighted = 0;
    for (const ValidatedLog& log : validation.logs) {
      const Prediction& rows = log.prediction;
      const auto usable = rows.usable(drive, false);
      for (Index k = 0; k < rows.rows(); ++k) {
        if (!usable(k)) continue;
        residual.push_back(rows.tau(k, drive) - rows.model(k, drive));
        q.push_back(rows.q(k, drive));
        qd.push_back(rows.qd(k, drive));
        qdd.push_back(rows.qdd(k, drive));
      }
      if (rows.rows() > 1) {
        weighted += static_cast<double>(usable.count()) *
                    residual_memory(rows.tau.col(drive) - rows.model.col(drive), usable, log.row_rate_hz);
      }
    }
    ResidualStructure& out = result[j];
    out.rows = static_cast<Index>(residual.size());
    if (out.rows == 0) continue;
    out.correlation = weighted / static_cast<double>(out.rows);
    const auto vector = [](const std::vector<double>& values) -> Eigen::VectorXd {
      return Eigen::VectorXd::Map(values.data(), std::ssize(values));
    };
    const Eigen::VectorXd e = vector(residual);
    out.on_velocity = dependence_on(vector(qd), e);
    out.on_position = dependence_on(vector(q), e);
    out.on_acceleration = dependence_on(vector(qdd), e);
  }
  return result;
}

}  // namespace deltadyn
