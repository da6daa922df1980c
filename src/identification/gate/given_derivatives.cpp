#include "given_derivatives.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "deltadyn/signal/butterworth.hpp"
#include "deltadyn/signal/differentiate_log.hpp"
#include "deltadyn/signal/log_columns.hpp"
#include "deltadyn/signal/log_part.hpp"

#include "sample.hpp"

namespace deltadyn::gate {

namespace {

using Eigen::Index;

constexpr Index kMostRows = 20000;
constexpr double kLatest_s = 0.05;     // derivatives later than this are no derivatives
constexpr double kLate_s = 2e-4;       // a later derivative spoils Coulomb friction at reversals
constexpr double kWrongFactor = 0.02;  // of a rate: more is no noise of a filter
constexpr double kRelated = 0.8;       // share of a derivative's square that the positions' own derivative explains
constexpr double kRoughness = 0.3;     // third over first differences: above, the rows are no motion but single states

/// A given derivative against the positions' own.
struct Comparison {
  double factor = 1, factor_std = 0;
  double delay_s = 0, delay_std = 0;
  double related = 1;  ///< share explained
  bool zero = false;
};

/// Rows that follow one another evenly and smoothly in time.
bool is_motion(const Log& log) {
  const Index n = log.samples();
  if (n < 100) return false;
  const double step = log.sample_time_s();
  for (Index k = 1; k < n; ++k) {
    if (std::abs(log.t_s(k) - log.t_s(k - 1) - step) > 0.1 * step) return false;
  }
  for (Index j = 0; j < log.drives(); ++j) {
    const Eigen::VectorXd first = log.q.col(j).tail(n - 1) - log.q.col(j).head(n - 1);
    const Eigen::VectorXd third = first.tail(n - 3) - 2 * first.segment(1, n - 3) + first.head(n - 3);
    if (third.norm() > kRoughness * first.norm()) return false;
  }
  return true;
}

/// \param own, slope  the positions' derivative and its own derivative by time
Comparison compare(const Eigen::VectorXd& given, const Eigen::VectorXd& own, const Eigen::VectorXd& slope,
                   double step_s, double independent) {
  Comparison out;
  const Index n = given.size();
  const auto reach = std::min<Index>(n / 4, static_cast<Index>(std::ceil(kLatest_s / step_s)));
  const Index inner = n - 2 * reach;
  const auto g = given.segment(reach, inner);
  if (g.squaredNorm() < 1e-10 * own.squaredNorm()) {
    out.zero = true;
    return out;
  }
  double least = 1e300;
  Index best = 0;
  for (Index s = -reach; s <= reach; ++s) {
    const auto v = own.segment(reach - s, inner);
    const double left = g.squaredNorm() - std::pow(g.dot(v), 2) / std::max(v.squaredNorm(), 1e-300);
    if (left < least) {
      least = left;
      best = s;
    }
  }
  Eigen::MatrixXd A(inner, 2);
  A << own.segment(reach - best, inner), slope.segment(reach - best, inner);
  const Eigen::Vector2d x = (A.transpose() * A).ldlt().solve(A.transpose() * g);
  const double left = (g - A * x).squaredNorm();
  out.related = 1 - left / g.squaredNorm();
  out.factor = x(0);
  out.delay_s = static_cast<double>(best) * step_s - x(1) / x(0);
  const double noise = std::sqrt(left / std::max(1.0, independent));
  const double rows = static_cast<double>(inner);
  out.factor_std = noise / std::sqrt(A.col(0).squaredNorm() / rows) / std::sqrt(std::max(1.0, independent));
  out.delay_std =
      noise / (std::abs(x(0)) * std::sqrt(A.col(1).squaredNorm() / rows)) / std::sqrt(std::max(1.0, independent));
  return out;
}

std::string factor_in_words(double factor, int derivative) {
  const double rpm = 30 / std::numbers::pi, degrees = 180 / std::numbers::pi;
  if (derivative == 1 && std::abs(factor / rpm - 1) < 0.01) return ": revolutions per minute?";
  if (std::abs(factor / degrees - 1) < 0.01) return ": degrees?";
  if (std::abs(factor + 1) < 0.02) return ": the sign is wrong";
  if (std::abs(factor * 2 * std::numbers::pi - 1) < 0.01) return ": turns?";
  return "";
}

/// What is wrong with one column; empty: nothing.
std::string wrong(const Comparison& c, const std::string& column, const std::string& own, int derivative) {
  if (c.zero) return fmt::format("{} is zero while the drive moves", column);
  if (c.related < kRelated)
    return fmt::format("{} does not follow {} ({:.0f} % of it explained)", column, own, 100 * std::max(0.0, c.related));
  std::string text;
  if (std::abs(c.factor - 1) > std::max(kWrongFactor, 5 * c.factor_std))
    text = fmt::format("{} is {:.3g} times {}{}", column, c.factor, own, factor_in_words(c.factor, derivative));
  if (std::abs(c.delay_s) > std::max(kLate_s, 5 * c.delay_std)) {
    text += fmt::format("{} {:.1f} ms {}", text.empty() ? column + " is" : " and", 1e3 * std::abs(c.delay_s),
                        c.delay_s > 0 ? "late" : "early");
  }
  return text;
}

}  // namespace

std::vector<LogFinding> examine_derivatives(const RobotDescription& robot, const Log& log, bool used) {
  std::vector<LogFinding> out;
  if (log.qd.size() == 0 || !is_motion(log)) return out;
  const Log piece = middle_of(log, kMostRows);
  const Index rows = piece.samples(), from = (log.samples() - rows) / 2;
  const double rate_hz = 1 / log.sample_time_s();
  const double cutoff_hz = std::min(2 * noise_limited_band_hz({piece}, {}), 0.4 * rate_hz);
  const double length_s = static_cast<double>(rows) / rate_hz;
  if (length_s < 0.3 + 6 / cutoff_hz) return out;
  const DriveMotion own = differentiate_log(piece, cutoff_hz);
  const Index count = own.last - own.first;
  const double independent = static_cast<double>(count) * std::min(1.0, 2 * cutoff_hz / rate_hz);
  for (const int derivative : {1, 2}) {
    const Eigen::MatrixXd& given = derivative == 1 ? log.qd : log.qdd;
    if (given.size() == 0) continue;
    const Eigen::MatrixXd smooth = zero_phase_filter(given.middleRows(from, rows), rate_hz, cutoff_hz);
    for (Index j = 0; j < log.drives(); ++j) {
      const Eigen::VectorXd v = derivative == 1 ? own.qd.col(j) : own.qdd.col(j);
      Eigen::VectorXd slope = Eigen::VectorXd::Zero(rows);
      slope.segment(1, rows - 2) = (v.tail(rows - 2) - v.head(rows - 2)) * (0.5 * rate_hz);
      if (v.segment(own.first, count).norm() < 1e-9) continue;  // at rest
      const Comparison c = compare(smooth.col(j).segment(own.first, count), v.segment(own.first, count),
                                   slope.segment(own.first, count), 1 / rate_hz, independent);
      const auto names = drive_columns(robot, static_cast<int>(j));
      const std::string text =
          wrong(c, derivative == 1 ? fmt::format("qd{}", j + 1) : fmt::format("qdd{}", j + 1),
                derivative == 1 ? fmt::format("dq{}/dt", j + 1) : fmt::format("d2q{}/dt2", j + 1), derivative);
      if (text.empty()) continue;
      const bool late = std::abs(c.delay_s) > kLate_s;
      out.push_back(
          {.level = used ? FindingLevel::fault : FindingLevel::warning,
           .key = derivative == 1 ? "rate" : "acceleration",
           .file = log.file,
           .drive = static_cast<int>(j),
           .value = late ? c.delay_s : c.factor,
           .std = late ? c.delay_std : c.factor_std,
           .unit = late ? "s" : "",
           .text = text + (used ? "" : "; it is not used, the positions are differentiated"),
           .mend =
               used ? "leave out --no-filter (the tool then differentiates the positions), or give the right column " +
                          (derivative == 1 ? names.qd : names.qdd)
                    : ""});
    }
  }
  return out;
}

}  // namespace deltadyn::gate
