/// \file
/// A torque that stays at exactly one value: the servo is off, a brake holds, or the recorder lost the channel. That
/// stretch is left out.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "deltadyn/runtime/statistics.hpp"
#include "deltadyn/signal/log_columns.hpp"

#include "checks.hpp"
#include "sample_stretches.hpp"

namespace deltadyn::checks {
namespace {

constexpr double kShortest_s = 0.05;
// By chance a torque that repeats in every second row does so once in a million rows
constexpr Index kShortestRows = 20;
constexpr double kLongest_s = 0.5;   // a torque that reaches a limit leaves it again sooner
constexpr double kJump = 8.0;        // usual changes: the servo switches, where a limit is reached smoothly,
constexpr double kJumpNearby = 3.0;  // or times the changes just outside the run
// Of the rows that repeat: then steps are coarser than the noise, and runs are long by nature
constexpr double kCoarseShare = 0.5;
constexpr double kCoarseRuns = 30.0;   // times the usual run
constexpr double kNoiseFree = 1e-3;    // of the travel: kinks of a torque without noise look like as much
constexpr double kMostConstant = 0.9;  // of the samples; then nothing is left

struct Run {
  Index drive, begin, end;
  double value;
  bool resting;
};

/// Does the torque jump into or out of [begin, end)? At a limit that is reached the changes outside are no smaller.
bool jumps_at_an_end(const Eigen::Ref<const Eigen::VectorXd>& tau, Index begin, Index end, double usual_change) {
  constexpr Index kNear = 6;
  double nearby = usual_change * kJump / kJumpNearby;
  for (Index i = std::max<Index>(1, begin - kNear); i < begin; ++i)
    nearby = std::max(nearby, std::abs(tau(i) - tau(i - 1)));
  for (Index i = end + 1; i < std::min(tau.size(), end + kNear); ++i)
    nearby = std::max(nearby, std::abs(tau(i) - tau(i - 1)));
  const double into = begin > 0 ? std::abs(tau(begin) - tau(begin - 1)) : 0.0;
  const double out = end < tau.size() ? std::abs(tau(end) - tau(end - 1)) : 0.0;
  return std::max(into, out) > kJumpNearby * nearby;
}

/// Runs of one drive that are neither chance nor a limit that is reached.
std::vector<Run> runs_of(const CheckRoom& room, Index d) {
  const Log& log = room.log;
  const auto tau = log.tau.col(d);
  const double h = log.sample_time_s();
  const auto shortest = std::max<Index>(kShortestRows, static_cast<Index>(std::lround(kShortest_s / h)));
  std::vector<Run> runs;
  std::vector<double> changes;
  double repeats = 0, rows = 0;
  for_each_run(tau, [&](Index begin, Index end) {
    if (end - begin >= shortest) {
      runs.push_back({d, begin, end, tau(begin), false});
    } else {
      rows += static_cast<double>(end - begin);
      repeats += static_cast<double>(end - begin - 1);
      // Every seventh will do
      if (begin > 0 && begin % 7 == 0) changes.push_back(std::abs(tau(begin) - tau(begin - 1)));
    }
  });
  if (runs.empty()) return runs;
  const double usual_change = lower_median(std::move(changes));
  const double usual_run = rows > repeats ? rows / (rows - repeats) : 1.0;
  const bool coarse = repeats > kCoarseShare * rows;
  const ChannelQuality quality = measure_channel(tau);
  const bool noise_free = quality.noise < std::max(0.7 * quality.step, kNoiseFree * quality.travel);
  const double highest = tau.maxCoeff(), lowest = tau.minCoeff();
  const auto is_chance_or_limit = [&](Run& run) {
    const auto length = static_cast<double>(run.end - run.begin);
    run.resting =
        log.torque_out.size() > 0 &&
        static_cast<double>(log.torque_out.col(d).segment(run.begin, run.end - run.begin).count()) > 0.9 * length;
    // Without noise a drive at rest needs a constant torque.
    if (run.resting && (coarse || noise_free)) return true;
    if (coarse && length < kCoarseRuns * usual_run) return true;
    const bool jumps = jumps_at_an_end(tau, run.begin, run.end, usual_change);
    const bool extreme = run.value == highest || run.value == lowest;
    return !jumps && (coarse || (extreme && length * h < kLongest_s));
  };
  std::erase_if(runs, is_chance_or_limit);
  return runs;
}

std::string name_of(const std::vector<Run>& together, std::size_t drives) {
  const bool zero = std::ranges::all_of(together, [](const Run& run) { return run.value == 0; });
  const bool rest = std::ranges::all_of(together, &Run::resting);
  if (together.size() == drives && zero)
    return rest ? "the servo is off, or brakes hold the robot" : "the servo is off";
  if (rest) return "a brake holds, or the torque was not recorded";
  return zero ? "the servo is off, or the torque was not recorded" : "the recorded torque stands still";
}

}  // namespace

void check_constant_torque(CheckRoom& room) {
  const Log& log = room.log;
  std::vector<Run> all;
  for (Index d = 0; d < log.tau.cols(); ++d) {
    const std::string column = drive_columns(room.robot, static_cast<int>(d)).tau;
    if (log.tau.col(d).maxCoeff() == log.tau.col(d).minCoeff()) {
      if (!room.moves(d)) continue;
      throw UnusablePart(fmt::format("the torque is always {:.9g} while the drive moves", log.tau(0, d)),
                         room.where(0, column), "check that the torque was recorded");
    }
    const auto runs = runs_of(room, d);
    Index rows = 0;
    for (const Run& run : runs) rows += run.end - run.begin;
    if (static_cast<double>(rows) > kMostConstant * static_cast<double>(log.samples()) && room.moves(d)) {
      throw UnusablePart(fmt::format("the torque is constant in {:.3g} % of the samples while the drive moves",
                                     100.0 * static_cast<double>(rows) / static_cast<double>(log.samples())),
                         room.where(runs.front().begin, column), "check that the torque was recorded");
    }
    all.insert(all.end(), runs.begin(), runs.end());
  }
  std::ranges::sort(all, {}, &Run::begin);
  while (!all.empty()) {
    // Drives whose torque stands still at about the same time have one cause.
    const Run first = all.front();
    std::vector<Run> together, later;
    Index begin = first.begin, end = first.end;
    for (const Run& run : all) {
      const Index common = std::min(run.end, first.end) - std::max(run.begin, first.begin);
      (2 * common > first.end - first.begin ? together : later).push_back(run);
    }
    std::vector<std::string> columns;
    for (const Run& run : together) {
      room.log.leave_torque_out(run.drive, run.begin, run.end);
      begin = std::min(begin, run.begin);
      end = std::max(end, run.end);
      columns.push_back(
          fmt::format("{} = {:.4g}", drive_columns(room.robot, static_cast<int>(run.drive)).tau, run.value));
    }
    const bool alone = together.size() == 1;
    room.tell(FindingLevel::mended, "constant_torque", begin, "", alone ? static_cast<int>(first.drive) : -1,
              static_cast<double>(end - begin) * log.sample_time_s(), "s",
              fmt::format("from t = {:.4g} s to {:.4g} s the torque is constant ({}): {}; left out", log.t_s(begin),
                          log.t_s(end - 1), fmt::join(columns, ", "),
                          name_of(together, static_cast<std::size_t>(log.drives()))));
    all = std::move(later);
  }
}

}  // namespace deltadyn::checks
