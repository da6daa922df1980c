/// \file
/// From time stamps to even steps: lost rows get their place, stamps that only jitter are set right, and values that
/// were really taken at uneven times are moved.

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "deltadyn/runtime/statistics.hpp"
#include "deltadyn/signal/resample.hpp"

#include "checks.hpp"
#include "sample_stretches.hpp"

namespace deltadyn::checks {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kStampJitter = 0.02;      // up to this share of the sample time, stamps are set to the even grid
constexpr double kResampledJitter = 0.45;  // up to this share, the log is resampled onto the even grid
constexpr double kTrueStamps = 0.8;        // the positions are clearly smoother over the stamps than over even steps
constexpr double kEvenStep = 0.2;          // a step this share away from the usual one is still even
constexpr double kSlightDrift = 5e-3;      // of the clock: rates are wrong by no more, whichever clock was right
constexpr double kLongUneven = 2.5;        // usual steps; interpolation across more is no measurement

/// Median distance of the positions from the cubic through four neighbours, over the stamps divided by over even steps.
double roughness_over_stamps(const Log& log, const TimeGrid& grid) {
  const auto places = sample_stretches(log.samples(), 128);
  double sum = 0, count = 0;
  for (Index d = 0; d < log.drives(); ++d) {
    const auto q = log.q.col(d);
    std::vector<double> even, stamped;
    for (const auto& [begin, end] : places) {
      for (Index i = begin + 2; i + 2 < end; ++i) {
        const auto at = static_cast<std::size_t>(i);
        if (grid.index[at + 2] - grid.index[at - 2] != 4) continue;
        const double by_rows = q(i) - (4.0 * (q(i - 1) + q(i + 1)) - (q(i - 2) + q(i + 2))) / 6.0;
        if (!std::isfinite(by_rows)) continue;
        const std::array around{i - 2, i - 1, i + 1, i + 2};
        even.push_back(std::abs(by_rows));
        stamped.push_back(std::abs(q(i) - interpolate(log.t_s(around), q(around), log.t_s(i))));
      }
    }
    const double by_rows = lower_median(std::move(even));
    const double by_stamps = lower_median(std::move(stamped));
    if (by_rows <= 0 || by_stamps <= 0) continue;
    sum += std::log(by_stamps / by_rows);
    count += 1.0;
  }
  return count > 0 ? std::exp(sum / count) : 1.0;
}

/// Largest minus smallest mean step over tenths of the log, as a share: a clock that drifts.
double drift_of(const TimeGrid& grid, const Eigen::VectorXd& t) {
  constexpr Index kPieces = 10;
  const Index n = t.size();
  double lowest = 1e300, highest = 0;
  for (Index k = 0; k < kPieces; ++k) {
    const Index a = k * (n - 1) / kPieces;
    const Index b = (k + 1) * (n - 1) / kPieces;
    if (b <= a) continue;
    const auto rows =
        static_cast<double>(grid.index[static_cast<std::size_t>(b)] - grid.index[static_cast<std::size_t>(a)]);
    const double step = (t(b) - t(a)) / rows;
    lowest = std::min(lowest, step);
    highest = std::max(highest, step);
  }
  return (highest - lowest) / grid.step_s;
}

/// Share of the steps that are not a whole number of usual ones.
double uneven_share(const TimeGrid& grid, const Eigen::VectorXd& t) {
  double uneven = 0;
  for (Index i = 1; i < t.size(); ++i) {
    const auto rows =
        static_cast<double>(grid.index[static_cast<std::size_t>(i)] - grid.index[static_cast<std::size_t>(i - 1)]);
    if (std::abs((t(i) - t(i - 1)) / grid.step_s - rows) > kEvenStep) uneven += 1.0;
  }
  return uneven / static_cast<double>(t.size() - 1);
}

void say_uneven(const CheckRoom& room, const char* what_was_done) {
  const TimeGrid& grid = room.grid;
  room.tell(FindingLevel::mended, "uneven_stamps", grid.worst, "t_s", -1, grid.jitter, "",
            fmt::format("the time stamps jitter, this one is {:.2g} ms away from an even step of {:.6g} ms; {}",
                        1e3 * grid.jitter * grid.step_s, 1e3 * grid.step_s, what_was_done));
}

/// Are the stamps or the rows even, and what is to be done?
void judge_stamps(CheckRoom& room) {
  TimeGrid& grid = room.grid;
  room.largest_jitter = std::max(room.largest_jitter, grid.jitter);
  if (grid.jitter <= kStampJitter) return;
  const Eigen::VectorXd& t = room.log.t_s;
  const double drift = drift_of(grid, t);
  const bool locally_even = uneven_share(grid, t) < 0.05;
  if (grid.jitter > kResampledJitter && locally_even) {
    room.resample = drift > kSlightDrift;
    room.tell(drift > kSlightDrift ? FindingLevel::warning : FindingLevel::mended, "clock_drift", grid.worst, "t_s", -1,
              drift, "",
              fmt::format(
                  "the clock of the time stamps drifts: the time between samples changes by {:.2g} % over the log; {}",
                  100.0 * drift, room.resample ? "moved to even steps" : "the samples are taken as even"),
              drift > kSlightDrift ? "record with the time stamps of the controller's own clock" : "");
    return;
  }
  room.resample = roughness_over_stamps(room.log, grid) < kTrueStamps;
  if (!room.resample) {
    say_uneven(room, "the positions are smoother over even steps, so the samples were taken evenly: set to even steps");
    return;
  }
  if (grid.jitter > kResampledJitter) {
    // No row has a place of its own on an even grid: all rows stay, and the grid comes with the resampling.
    for (std::size_t i = 0; i < grid.index.size(); ++i) grid.index[i] = static_cast<Index>(i);
  }
  say_uneven(room, "the positions agree with the stamps, so the log was moved to even steps");
}

Eigen::VectorXd even_stamps(const TimeGrid& grid, Index samples) {
  Eigen::VectorXd even(samples);
  for (Index k = 0; k < samples; ++k) even(k) = grid.start_s + static_cast<double>(k) * grid.step_s;
  return even;
}

/// Adds the samples that are missing in time, without values yet.
void insert_lost_rows(CheckRoom& room) {
  Log& log = room.log;
  const TimeGrid& grid = room.grid;
  const Index had = log.samples();
  const Index wanted = grid.index.back() + 1;
  if (wanted == had) return;
  Eigen::VectorXd t_s = even_stamps(grid, wanted);
  std::vector<long> lines(log.line.empty() ? 0 : static_cast<std::size_t>(wanted), 0);
  Tally lost;
  for (std::size_t i = 0; i < grid.index.size(); ++i) {
    const auto k = static_cast<std::size_t>(grid.index[i]);
    t_s(grid.index[i]) = log.t_s(static_cast<Index>(i));
    if (!lines.empty()) lines[k] = log.line[i];
    const Index before = i > 0 ? grid.index[i] - grid.index[i - 1] - 1 : 0;
    if (before == 0) continue;
    lost.add(static_cast<Index>(i), before);
  }
  const double share = 100.0 * static_cast<double>(lost.count) / static_cast<double>(wanted);
  const std::string text = fmt::format(
      "{} sample(s) missing before this one{}",
      grid.index[static_cast<std::size_t>(lost.first)] - grid.index[static_cast<std::size_t>(lost.first - 1)] - 1,
      lost.count > 1 ? fmt::format(", {} in all ({:.2g} % of the rows)", lost.count, share) : "");
  room.tell(FindingLevel::mended, "lost_rows", lost.first, "", -1, static_cast<double>(lost.count), "rows",
            text + ", filled in");
  for (Eigen::MatrixXd* block : {&log.q, &log.qd, &log.qdd, &log.tau}) {
    if (block->size() == 0) continue;
    Eigen::MatrixXd wider = Eigen::MatrixXd::Constant(wanted, block->cols(), kNan);
    for (Index i = 0; i < had; ++i) wider.row(grid.index[static_cast<std::size_t>(i)]) = block->row(i);
    *block = std::move(wider);
  }
  if (!log.filled.empty()) {
    std::vector<char> filled(static_cast<std::size_t>(wanted), Log::kMeasured);
    for (std::size_t i = 0; i < grid.index.size(); ++i) filled[static_cast<std::size_t>(grid.index[i])] = log.filled[i];
    log.filled = std::move(filled);
  }
  log.t_s = std::move(t_s);
  log.line = std::move(lines);
}

/// Marks and line numbers of the rows nearest in time; rows within a long step are no measurement.
void carry_over(const Log& from, const Eigen::VectorXd& even, double step_s, Log& to) {
  Index k = 0;
  for (Index i = 0; i < even.size(); ++i) {
    while (k + 2 < from.samples() && from.t_s(k + 1) <= even(i)) ++k;
    const Index nearest = even(i) - from.t_s(k) < from.t_s(k + 1) - even(i) ? k : k + 1;
    const auto at = static_cast<std::size_t>(i);
    if (!from.line.empty()) to.line[at] = from.line[static_cast<std::size_t>(nearest)];
    char mark = from.filled.empty() ? Log::kMeasured : from.filled[static_cast<std::size_t>(nearest)];
    if (from.t_s(k + 1) - from.t_s(k) > kLongUneven * step_s) mark = Log::kLeftOut;
    if (mark != Log::kMeasured) {
      to.filled.resize(static_cast<std::size_t>(even.size()), Log::kMeasured);
      to.filled[at] = mark;
    }
    if (from.torque_out.size() > 0) to.torque_out.row(i) = from.torque_out.row(nearest);
  }
}

}  // namespace

void put_on_grid(CheckRoom& room) {
  room.grid = fit_time_grid(room.log.t_s);
  room.resample = false;
  judge_stamps(room);
  insert_lost_rows(room);
  constexpr double kRounding = 1e-6;
  const bool untouched =
      room.grid.jitter <= kRounding && room.grid.index.back() + 1 == static_cast<Index>(room.grid.index.size());
  if (!room.resample && !untouched) room.log.t_s = even_stamps(room.grid, room.log.samples());
}

void move_to_grid(CheckRoom& room) {
  if (!room.resample) return;
  Log& log = room.log;
  const Index n = log.samples();
  Index wanted = n;
  if (room.grid.jitter > kResampledJitter) {
    room.grid.start_s = log.t_s(0);
    wanted = static_cast<Index>(std::floor((log.t_s(n - 1) - log.t_s(0)) / room.grid.step_s + 1e-9)) + 1;
  }
  const Eigen::VectorXd even = even_stamps(room.grid, wanted);
  Log moved = log;
  moved.t_s = even;
  moved.line.assign(log.line.empty() ? 0 : static_cast<std::size_t>(wanted), 0);
  moved.filled.clear();
  if (log.torque_out.size() > 0) moved.torque_out.setConstant(wanted, log.drives(), false);
  for (const auto& [from, to] :
       {std::pair{&log.q, &moved.q}, {&log.qd, &moved.qd}, {&log.qdd, &moved.qdd}, {&log.tau, &moved.tau}}) {
    if (from->size() > 0) *to = resample(log.t_s, *from, even);
  }
  carry_over(log, even, room.grid.step_s, moved);
  log = std::move(moved);
}

}  // namespace deltadyn::checks
