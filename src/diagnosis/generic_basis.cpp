#include "generic_basis.hpp"

#include <algorithm>
#include <cmath>

namespace deltadyn {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kRowsForAll = 1600;  // that the full basis is made for

/// Knots at evenly spaced quantiles.
std::vector<double> knots(std::vector<double> values, int count) {
  std::vector<double> out;
  if (values.empty()) return out;
  std::sort(values.begin(), values.end());
  for (int k = 0; k < count; ++k) {
    const double at = k * static_cast<double>(values.size() - 1) / (count - 1);
    out.push_back(values[static_cast<std::size_t>(at)]);
  }
  out.erase(std::unique(out.begin(), out.end(), [](double a, double b) { return std::abs(a - b) < 1e-12; }), out.end());
  return out;
}

/// Piecewise linear hats over the knots, constant beyond the ends.
VectorXd hats(double x, const std::vector<double>& knot) {
  VectorXd h = VectorXd::Zero(static_cast<Index>(knot.size()));
  if (knot.empty()) return h;
  if (x <= knot.front()) {
    h(0) = 1;
  } else if (x >= knot.back()) {
    h(h.size() - 1) = 1;
  } else {
    const auto upper = static_cast<Index>(std::upper_bound(knot.begin(), knot.end(), x) - knot.begin());
    const double low = knot[static_cast<std::size_t>(upper - 1)], high = knot[static_cast<std::size_t>(upper)];
    h(upper) = (x - low) / (high - low);
    h(upper - 1) = 1 - h(upper);
  }
  return h;
}

/// A function of the row that becomes hats, times a factor.
struct Coordinate {
  std::string name;
  int count;
  double (*value)(const LogRows&, Index row, Index sample, Index drive, Index other);
  double (*factor)(const LogRows&, Index row, Index sample, Index drive);
  bool other = false;  ///< once for every other drive
};

double unit(const LogRows&, Index, Index, Index) {
  return 1;
}
double direction(const LogRows& log, Index row, Index, Index j) {
  return log.qd(row, j) > 0 ? 1.0 : -1.0;
}
double rate(const LogRows& log, Index row, Index, Index j) {
  return log.qd(row, j);
}
double position(const LogRows& log, Index row, Index, Index j, Index) {
  return log.q(row, j);
}
double speed(const LogRows& log, Index row, Index, Index j, Index) {
  return std::log(std::max(std::abs(log.qd(row, j)), 1e-9));
}
double acceleration(const LogRows& log, Index row, Index, Index j, Index) {
  return log.qdd(row, j);
}
double load(const LogRows& log, Index, Index sample, Index j, Index) {
  return log.signals.load(sample, j);
}
double torque(const LogRows& log, Index, Index sample, Index j, Index) {
  return log.signals.torque(sample, j);
}
double torque_rate(const LogRows& log, Index, Index sample, Index j, Index) {
  const MatrixXd& tau = log.signals.torque;
  const Index before = std::max<Index>(sample - 1, 0), after = std::min(sample + 1, tau.rows() - 1);
  return (tau(after, j) - tau(before, j)) / (static_cast<double>(after - before) * log.signals.sample_time_s);
}
double time(const LogRows& log, Index row, Index, Index, Index) {
  return log.t_s(row) - log.t_s(0);
}
double other_position(const LogRows& log, Index row, Index, Index, Index o) {
  return log.q(row, o);
}
double other_rate(const LogRows& log, Index row, Index, Index, Index o) {
  return log.qd(row, o);
}
double bar_rate(const LogRows& log, Index, Index sample, Index, Index) {
  return log.signals.bar_rate(sample);
}

const std::vector<Coordinate>& coordinates() {
  static const std::vector<Coordinate> all = {{"speed", 10, speed, direction},
                                              {"speed", 6, speed, unit},
                                              {"position", 10, position, unit},
                                              {"position", 6, position, direction},
                                              {"acceleration", 7, acceleration, unit},
                                              {"load", 6, torque, unit},
                                              {"load", 4, load, direction},
                                              {"torque rate", 4, torque_rate, unit},
                                              {"time", 6, time, unit},
                                              {"time", 4, time, rate},
                                              {"other joints", 4, other_position, unit, true},
                                              {"other joints", 4, other_rate, unit, true},
                                              {"other joints", 3, other_rate, direction, true},
                                              {"telescope", 6, bar_rate, unit}};
  return all;
}

}  // namespace

GenericBasis make_generic_basis(const std::vector<LogRows>& logs, const std::vector<LogRows>& more) {
  GenericBasis out;
  const Index n = logs.front().tau.cols();
  out.columns.resize(logs.size() + more.size());
  for (auto& log : out.columns) log.resize(static_cast<std::size_t>(n));
  out.coordinate.resize(static_cast<std::size_t>(n));
  out.blocks.resize(static_cast<std::size_t>(n));
  for (Index j = 0; j < n; ++j) {
    const auto drive = static_cast<std::size_t>(j);
    // Fewer knots for short logs: at least some twenty rows a column, or the basis would fit the noise.
    double rows = 0;
    for (const LogRows& log : logs) rows += static_cast<double>(log.usable[drive].count());
    const double share = std::min(1.0, rows / kRowsForAll);
    for (const Coordinate& coordinate : coordinates()) {
      for (Index o = 0; o < (coordinate.other ? n : 1); ++o) {
        if (coordinate.other && o == j) continue;
        std::vector<double> values;
        for (const LogRows& log : logs) {
          for (Index row = 0; row < log.rows(); ++row) {
            if (log.usable[drive](row)) values.push_back(coordinate.value(log, row, sample_of_row(log.log, row), j, o));
          }
        }
        const std::vector<double> knot =
            knots(values, std::max(2, static_cast<int>(std::lround(share * coordinate.count))));
        if (knot.size() < 2) continue;
        out.blocks[drive].emplace_back(static_cast<Index>(out.coordinate[drive].size()),
                                       static_cast<Index>(knot.size()));
        for (std::size_t k = 0; k < knot.size(); ++k) out.coordinate[drive].push_back(coordinate.name);
        for (std::size_t l = 0; l < logs.size() + more.size(); ++l) {
          const LogRows& log = l < logs.size() ? logs[l] : more[l - logs.size()];
          MatrixXd& to = out.columns[l][drive];
          const Index first = to.cols();
          to.conservativeResize(log.rows(), first + static_cast<Index>(knot.size()));
          for (Index row = 0; row < log.rows(); ++row) {
            const Index sample = sample_of_row(log.log, row);
            to.row(row).tail(static_cast<Index>(knot.size())) =
                coordinate.factor(log, row, sample, j) *
                hats(coordinate.value(log, row, sample, j, o), knot).transpose();
          }
        }
      }
    }
  }
  return out;
}

}  // namespace deltadyn
