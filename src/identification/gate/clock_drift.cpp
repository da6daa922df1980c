#include "clock_drift.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/signal/log_part.hpp"
#include "deltadyn/signal/torque_timing_mend.hpp"

#include "sample.hpp"
#include "torque_timing.hpp"

namespace deltadyn::gate {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kPartsOfFile = 4;  // of a file: enough to see that a delay grows in a line
constexpr double kShortestPart_s = 2;
constexpr double kLongestPart_s = 30;    // its middle tells a delay as well as all of it
constexpr double kRateSigmas = 5;        // of a rate
constexpr double kOffShare = 0.15;       // of the change over the file: so far a part may lie off the line
constexpr double kLeastChange_s = 2e-4;  // less is for the one delay of the file
constexpr double kTakesAway = 0.75;      // of the residual may be left; parts of sound logs leave 0.9 and more

/// The middle of a part of a file, and the time that the whole part takes.
struct Part {
  int file = 0;
  double first_s = 0, last_s = 0;
};

/// Parts of all logs, each under a name of its own, so that it may have a delay of its own.
std::vector<Log> parts_of(const std::vector<Log>& logs, std::vector<Part>& which) {
  const std::vector<int> files = file_numbers(logs);
  std::vector<Log> parts;
  for (std::size_t l = 0; l < logs.size(); ++l) {
    const Log& log = logs[l];
    const double length_s = log.sample_time_s() * static_cast<double>(log.samples());
    const Index count = std::clamp<Index>(static_cast<Index>(length_s / kShortestPart_s), 1, kPartsOfFile);
    for (Index k = 0; k < count; ++k) {
      const Index from = k * log.samples() / count, to = (k + 1) * log.samples() / count;
      const Index most = static_cast<Index>(kLongestPart_s / log.sample_time_s()), length = std::min(to - from, most);
      parts.push_back(part_of(log, from + (to - from - length) / 2, length));
      parts.back().file += fmt::format("#{}", parts.size());
      which.push_back({files[l], log.t_s(from), log.t_s(to - 1)});
    }
  }
  return parts;
}

/// Straight line through the delays of one file's parts; nothing if they do not lie on one that rises or falls. How far
/// they are off it says more of their uncertainty than their own deviations do, in which the drift inside of a part
/// counts as noise.
std::optional<ClockDrift> line_through(const VectorXd& t, const VectorXd& delay) {
  if (t.size() < 3) return std::nullopt;
  const auto count = static_cast<double>(t.size());
  ClockDrift out;
  out.t_s = t.mean();
  out.delay_s = delay.mean();
  const VectorXd x = t.array() - out.t_s;
  out.rate = x.dot(delay) / x.squaredNorm();
  const Eigen::ArrayXd off = (delay.array() - out.delay_s - out.rate * x.array()).abs();
  out.rate_std = std::sqrt(off.square().sum() / (count - 2) / x.squaredNorm());
  const double change = std::abs(out.rate) * (t.maxCoeff() - t.minCoeff());
  if (change < kLeastChange_s || std::abs(out.rate) < kRateSigmas * out.rate_std || off.maxCoeff() > kOffShare * change)
    return std::nullopt;
  return out;
}

}  // namespace

std::optional<ClockDrifts> find_clock_drift(const Robot& robot, const BaseParameters& base,
                                            const std::vector<Log>& logs, double highest_band_hz) {
  std::vector<Part> which;
  const std::vector<Log> parts = parts_of(logs, which);
  SampleOptions options;
  options.highest_band_hz = highest_band_hz;
  options.stretches = 1;
  const Sample sample = take_sample(parts, options);
  if (sample.stretches.size() < parts.size()) return std::nullopt;
  const Rows rows = low_passed_rows(robot, base, sample, Reading::as_given(robot.drives()));
  const auto [delay, before, after] = delays_of_logs(sample, rows, static_cast<int>(parts.size()));
  if (delay.size() == 0 || after > kTakesAway * before) return std::nullopt;

  ClockDrifts out;
  out.rms_before = before;
  out.rms_after = after;
  bool any = false;
  const int files = which.back().file + 1;
  for (int file = 0; file < files; ++file) {
    std::vector<double> t, d;
    double first = 1e300, last = -1e300;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      if (which[k].file != file) continue;
      first = std::min(first, which[k].first_s);
      last = std::max(last, which[k].last_s);
      t.push_back(0.5 * (which[k].first_s + which[k].last_s));
      d.push_back(delay(static_cast<Index>(k)));
    }
    std::optional<ClockDrift> line =
        line_through(VectorXd::Map(t.data(), std::ssize(t)), VectorXd::Map(d.data(), std::ssize(d)));
    any = any || line.has_value();
    if (!line) line = ClockDrift{};
    line->first_s = line->delay_s + line->rate * (first - line->t_s);
    line->last_s = line->delay_s + line->rate * (last - line->t_s);
    out.files.push_back(*line);
  }
  if (!any) return std::nullopt;
  return out;
}

void take_drift_out(const ClockDrift& drift, Log& log) {
  if (drift.rate == 0) return;
  const Index n = log.samples();
  const VectorXd delay = drift.delay_s + drift.rate * (log.t_s.array() - drift.t_s);
  for (Index j = 0; j < log.drives(); ++j) log.tau.col(j) = mend_delays(log.tau.col(j), log.sample_time_s(), delay);
  for (Index k = 0; k < n; ++k) {
    const double at = log.t_s(k) + delay(k);
    if (at < log.t_s(0) || at > log.t_s(n - 1)) log.leave_out(k, k + 1);
  }
}

}  // namespace deltadyn::gate
