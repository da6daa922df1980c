#include "generic_basis.hpp"

#include <algorithm>
#include <cmath>

namespace deltadyn {

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

/// A row of a log, for a drive, and of another one where a coordinate is of that.
struct BasisRow {
  const LogRows& log;
  Index row, sample, drive, other;

  [[nodiscard]] double qd() const { return log.qd(row, drive); }
};

using OfRow = double (*)(const BasisRow&);

/// A function of the row that becomes hats, times a factor.
struct Coordinate {
  std::string name;
  int count;
  OfRow value, factor;
  bool other = false;  ///< once for every other drive
};

double torque_rate(const BasisRow& at) {
  const MatrixXd& tau = at.log.signals.torque;
  const Index before = std::max<Index>(at.sample - 1, 0), after = std::min(at.sample + 1, tau.rows() - 1);
  return (tau(after, at.drive) - tau(before, at.drive)) /
         (static_cast<double>(after - before) * at.log.signals.sample_time_s);
}

const std::vector<Coordinate>& coordinates() {
  constexpr OfRow unit = [](const BasisRow&) { return 1.0; };
  constexpr OfRow direction = [](const BasisRow& at) { return at.qd() > 0 ? 1.0 : -1.0; };
  constexpr OfRow rate = [](const BasisRow& at) { return at.qd(); };
  constexpr OfRow speed = [](const BasisRow& at) { return std::log(std::max(std::abs(at.qd()), 1e-9)); };
  constexpr OfRow position = [](const BasisRow& at) { return at.log.q(at.row, at.drive); };
  constexpr OfRow acceleration = [](const BasisRow& at) { return at.log.qdd(at.row, at.drive); };
  constexpr OfRow load = [](const BasisRow& at) { return at.log.signals.load(at.sample, at.drive); };
  constexpr OfRow torque = [](const BasisRow& at) { return at.log.signals.torque(at.sample, at.drive); };
  constexpr OfRow time = [](const BasisRow& at) { return at.log.t_s(at.row) - at.log.t_s(0); };
  constexpr OfRow other_position = [](const BasisRow& at) { return at.log.q(at.row, at.other); };
  constexpr OfRow other_rate = [](const BasisRow& at) { return at.log.qd(at.row, at.other); };
  constexpr OfRow inner_rate = [](const BasisRow& at) { return at.log.signals.inner_rate(at.sample); };
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
                                              {"inner joint", 6, inner_rate, unit}};
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
            if (log.usable[drive](row))
              values.push_back(coordinate.value({log, row, sample_of_row(log.log, row), j, o}));
          }
        }
        const std::vector<double> knot =
            knots(values, std::max(2, static_cast<int>(std::lround(share * coordinate.count))));
        if (knot.size() < 2) continue;
        out.blocks[drive].emplace_back(static_cast<Index>(out.coordinate[drive].size()),
                                       static_cast<Index>(knot.size()));
        out.coordinate[drive].insert(out.coordinate[drive].end(), knot.size(), coordinate.name);
        for (std::size_t l = 0; l < logs.size() + more.size(); ++l) {
          const LogRows& log = l < logs.size() ? logs[l] : more[l - logs.size()];
          MatrixXd& to = out.columns[l][drive];
          const Index first = to.cols();
          to.conservativeResize(log.rows(), first + static_cast<Index>(knot.size()));
          for (Index row = 0; row < log.rows(); ++row) {
            const BasisRow at{log, row, sample_of_row(log.log, row), j, o};
            to.row(row).tail(static_cast<Index>(knot.size())) =
                coordinate.factor(at) * hats(coordinate.value(at), knot).transpose();
          }
        }
      }
    }
  }
  return out;
}

}  // namespace deltadyn
