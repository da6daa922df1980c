/// \file
/// Values that were not measured anew: rows that hold those of the row before, and channels that change only every n-th
/// row because the recorder is faster than the bus. What repeats becomes a missing number.
///
/// A coarse encoder in slow motion and a robot at rest repeat values, too. A repeat counts only where the channel
/// changes by several of its own steps from row to row.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

#include "deltadyn/signal/log_columns.hpp"

#include "checks.hpp"
#include "sample_stretches.hpp"

namespace deltadyn::checks {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kStaleShare = 0.15;    // of the rows; fewer repeats are single held values, mended one by one
constexpr Index kFewestJudged = 200;    // rows to judge a channel by
constexpr double kStepsOfChange = 8.0;  // in units of the smallest change: equality by chance is then below 1 in 25
// rows; slower updates are another matter (a stuck encoder, a servo that is off)
constexpr int kMostHeld = 64;

/// Mean number of rows between two changes, over the runs of equal values that lie between two changes by many steps; 1
/// if the channel is fresh in (nearly) every row. A robot that stops and starts again has a small change on either side
/// of its rest.
double rows_between_changes(const Eigen::Ref<const Eigen::VectorXd>& x, double smallest) {
  constexpr Index kStretchRows = 512;
  const double many = kStepsOfChange * smallest;
  double rows = 0, repeats = 0;
  for (const auto& [begin, end] : sample_stretches(x.size(), kStretchRows)) {
    bool large_before = false;
    Index run = begin;
    for (Index i = begin + 1; i < end; ++i) {
      if (x(i) == x(i - 1)) continue;
      const bool large = std::abs(x(i) - x(i - 1)) >= many;  // false where a number is missing
      if (large && large_before && i - run <= kMostHeld) {
        rows += static_cast<double>(i - run);
        repeats += static_cast<double>(i - run - 1);
      }
      large_before = large;
      run = i;
    }
  }
  if (rows < static_cast<double>(kFewestJudged) || repeats < kStaleShare * rows) return 1.0;
  return rows / (rows - repeats);
}

/// Rows in which the value is new. Behind a lost row it may have been new already in that one.
std::vector<Index> changes_of(const Eigen::Ref<const Eigen::VectorXd>& x, const Eigen::VectorXd& t_s) {
  const double step = (t_s(t_s.size() - 1) - t_s(0)) / static_cast<double>(t_s.size() - 1);
  std::vector<Index> rows{0};
  for (Index i = 1; i < x.size(); ++i) {
    if (x(i) != x(i - 1) && !(t_s(i) - t_s(i - 1) > 1.7 * step)) rows.push_back(i);
  }
  return rows;
}

struct StaleChannel {
  Channel channel;
  double rows = 1;  ///< between two updates
  ChannelQuality quality;
  std::vector<Index> updates;
};

/// Channels that come in one message change in the same rows, apart from those that happen to stand still.
void share_updates(std::vector<StaleChannel>& stale) {
  for (std::size_t a = 0; a < stale.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      if (stale[a].rows < 1.6 || std::abs(stale[a].rows - stale[b].rows) > 0.2 * stale[a].rows) continue;
      auto &mine = stale[a].updates, &theirs = stale[b].updates;
      std::vector<Index> both, either;
      std::ranges::set_intersection(mine, theirs, std::back_inserter(both));
      if (static_cast<double>(both.size()) < 0.9 * static_cast<double>(std::min(mine.size(), theirs.size()))) continue;
      std::ranges::set_union(mine, theirs, std::back_inserter(either));
      mine = theirs = either;
    }
  }
}

/// Where the value stays for longer than the rhythm and then goes on by a small step, updates came and brought the same
/// value.
void insert_quiet_updates(StaleChannel& one, Index samples) {
  const auto rhythm = static_cast<Index>(std::lround(one.rows));
  const auto x = one.channel.values();
  const double small = std::max(2.0 * one.quality.smallest, 3.0 * one.quality.noise);
  std::vector<Index> all;
  for (std::size_t k = 0; k < one.updates.size(); ++k) {
    const Index from = one.updates[k];
    const Index to = k + 1 < one.updates.size() ? one.updates[k + 1] : samples;
    all.push_back(from);
    const bool quiet = to == samples || std::abs(x(to) - x(from)) <= small || to - from > 3 * rhythm;
    if (!quiet) continue;  // an update was lost
    for (Index row = from + rhythm; 2 * (to - row) > rhythm; row += rhythm) all.push_back(row);
  }
  one.updates = std::move(all);
}

void keep_updates_only(StaleChannel& one) {
  auto x = one.channel.block->col(one.channel.drive);
  const Eigen::VectorXd recorded = x;
  x.setConstant(kUnknown);
  for (const Index i : one.updates) x(i) = recorded(i);
}

/// One sentence for all, and the figure of each.
void say_stale(const CheckRoom& room, const std::vector<StaleChannel>& stale) {
  std::vector<std::string> channels;
  for (const StaleChannel& one : stale)
    channels.push_back(fmt::format("{} (every {:.3g} rows)", one.channel.name, one.rows));
  for (std::size_t k = 0; k < stale.size(); ++k) {
    room.tell({.level = FindingLevel::mended,
               .key = stale[k].channel.position ? "stale" : "stale_torque",
               .drive = static_cast<int>(stale[k].channel.drive),
               .value = stale[k].rows,
               .unit = "rows",
               .text = fmt::format(
                   "{}: recorded faster than measured, values are repeated and change only now and again: {}; the "
                   "log is taken at this rate",
                   room.log.file, fmt::join(channels, ", "))},
              k == 0);
  }
}

void find_stale_channels(CheckRoom& room) {
  std::vector<StaleChannel> stale;
  for (const Channel& channel : room.channels()) {
    if (channel.block != &room.log.q && channel.block != &room.log.tau) continue;
    const ChannelQuality quality = measure_channel(channel.values());
    if (quality.smallest <= 0 || quality.repeat_share < kStaleShare / 4) continue;
    const double rows = rows_between_changes(channel.values(), quality.smallest);
    if (rows <= 1.0) continue;
    stale.push_back({channel, rows, quality, changes_of(channel.values(), room.log.t_s)});
  }
  share_updates(stale);
  say_stale(room, stale);
  for (StaleChannel& one : stale) {
    insert_quiet_updates(one, room.log.samples());
    const int rhythm = std::max(1, static_cast<int>(std::lround(one.rows)));
    const auto drive = static_cast<std::size_t>(one.channel.drive);
    (one.channel.position ? room.stale_positions : room.stale_torques)[drive] = std::max(2, rhythm);
    room.thinning = std::max(room.thinning, rhythm);
    keep_updates_only(one);
  }
}

/// Single values held where the position before and behind moves on by several steps a row.
class HeldRows {
 public:
  explicit HeldRows(CheckRoom& room) : room_(room) {
    for (Index d = 0; d < room.log.drives(); ++d) {
      const ChannelQuality quality = measure_channel(room.log.q.col(d));
      least_change_.push_back(std::max(2.5 * quality.smallest, 6.0 * quality.noise));
    }
    // Torques that hardly ever repeat prove a held row by themselves, if none of them changes.
    double chance = 1;
    for (Index d = 0; d < room.log.tau.cols(); ++d) chance *= measure_channel(room.log.tau.col(d)).repeat_share;
    torques_prove_ = room.log.tau.cols() > 0 && chance < 1e-3;
  }

  void mark() {
    Log& log = room_.log;
    const Index n = log.samples();
    Tally rows;
    std::vector<Tally> single(static_cast<std::size_t>(log.drives()));
    std::vector<std::pair<Index, Index>> missing;  // sample, drive; -1: all
    for (Index i = 1; i < n; ++i) {
      if (!log.q.row(i).cwiseEqual(log.q.row(i - 1)).any()) continue;
      if (whole_row(i) && (moving(i) || (torques_prove_ && short_run(i) && not_at_rest(i)))) {
        rows.add(i);
        missing.emplace_back(i, -1);
        continue;
      }
      for (Index d = 0; d < log.drives(); ++d) {
        if (log.q(i, d) != log.q(i - 1, d) || !moves_on(i, d)) continue;
        single[static_cast<std::size_t>(d)].add(i);
        missing.emplace_back(i, d);
      }
    }
    for (const auto& [sample, drive] : missing) erase(sample, drive);
    say(rows, single);
  }

 private:
  [[nodiscard]] bool whole_row(Index i) const {
    const Log& log = room_.log;
    for (const Eigen::MatrixXd* block : {&log.q, &log.qd, &log.qdd, &log.tau}) {
      if (block->size() > 0 && !block->row(i).cwiseEqual(block->row(i - 1)).all()) return false;
    }
    return true;
  }

  [[nodiscard]] bool moving(Index i) const {
    for (Index d = 0; d < room_.log.drives(); ++d) {
      if (moves_on(i, d)) return true;
    }
    return false;
  }

  /// The position moves by several steps a row before and behind the run of equal values around i, in one direction.
  [[nodiscard]] bool moves_on(Index i, Index d) const {
    constexpr Index kBack = 3;
    const auto q = room_.log.q.col(d);
    Index first = i - 1;
    while (first > 0 && q(first - 1) == q(first)) --first;
    Index next = i + 1;
    while (next < q.size() && q(next) == q(i)) ++next;
    if (first < kBack || next + kBack >= q.size() || next - first > kMostHeld) return false;
    const double before = (q(first) - q(first - kBack)) / static_cast<double>(kBack);
    const double behind = (q(next + kBack) - q(next)) / static_cast<double>(kBack);
    const double least = least_change_[static_cast<std::size_t>(d)];
    return before * behind > 0 && std::abs(before) > least && std::abs(behind) > least;
  }

  /// The run of equal rows around i is over after a few rows; a robot at rest without noise makes long ones.
  [[nodiscard]] bool short_run(Index i) const {
    constexpr Index kLongest = 8;
    Index run = 1;
    for (Index k = i + 1; k < room_.log.samples() && run <= kLongest && whole_row(k); ++k) ++run;
    for (Index k = i - 1; k > 0 && run <= kLongest && whole_row(k); --k) ++run;
    return run <= kLongest;
  }

  /// Some position changes within a few rows.
  [[nodiscard]] bool not_at_rest(Index i) const {
    constexpr Index kNear = 8;
    const Log& log = room_.log;
    const Index a = std::max<Index>(0, i - kNear);
    const Index b = std::min(log.samples() - 1, i + kNear);
    return !log.q.row(a).cwiseEqual(log.q.row(b)).all();
  }

  void erase(Index sample, Index drive) const {
    Log& log = room_.log;
    room_.mark_filled(sample, Log::kBridged);
    if (drive >= 0) {
      log.q(sample, drive) = kUnknown;
      return;
    }
    for (Eigen::MatrixXd* block : {&log.q, &log.qd, &log.qdd, &log.tau}) {
      if (block->size() > 0) block->row(sample).setConstant(kUnknown);
    }
  }

  void say(const Tally& rows, const std::vector<Tally>& single) const {
    const auto share = [&](Index count) {
      return 100.0 * static_cast<double>(count) / static_cast<double>(room_.log.samples());
    };
    if (rows.count > 0) {
      room_.tell(
          FindingLevel::mended, "held_rows", rows.first, "", -1, static_cast<double>(rows.count), "rows",
          fmt::format("the row repeats the values of the row before while the robot moves, the first of {} such rows "
                      "({:.2g} %): taken as missing",
                      rows.count, share(rows.count)));
    }
    for (std::size_t d = 0; d < single.size(); ++d) {
      if (single[d].count == 0) continue;
      const auto drive = static_cast<int>(d);
      room_.tell(
          FindingLevel::mended, "held_position", single[d].first, drive_columns(room_.robot, drive).q, drive,
          static_cast<double>(single[d].count), "rows",
          fmt::format(
              "the position repeats while the drive moves, here and in {} rows in all ({:.2g} %): taken as missing",
              single[d].count, share(single[d].count)));
    }
  }

  CheckRoom& room_;
  std::vector<double> least_change_;
  bool torques_prove_ = false;
};

}  // namespace

void find_repeats(CheckRoom& room) {
  room.stale_positions.assign(static_cast<std::size_t>(room.log.drives()), 1);
  room.stale_torques.assign(static_cast<std::size_t>(room.log.drives()), 1);
  find_stale_channels(room);
  HeldRows(room).mark();
}

}  // namespace deltadyn::checks
