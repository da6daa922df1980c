/// \file
/// Missing numbers get values from their neighbours. Whether a row may still be used is decided by trial: the same
/// filling is done where the value is known, and if its error is no more than the noise, the sample is as good as
/// measured.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/signal/resample.hpp"

#include "checks.hpp"
#include "sample_stretches.hpp"

namespace deltadyn::checks {
namespace {

/// Errors of filling up to this many times the noise: three measured neighbours on either side leave 1.5 times for one
/// sample and 2.4 times for three, the noise of the value it is compared with included. The filters average over tens
/// of samples, so that one such sample widens a row's error by less than half.
constexpr double kNoiseRatio = 3.0;
/// ... or up to this share of the range, where a log is free of noise: through the differentiation of the filters that
/// is below 1e-4 of the acceleration.
constexpr double kShareOfPositions = 1e-6;
constexpr double kShareOfTorques = 1e-3;
constexpr Index kEachColumn = 2;     // columns that are named one by one
constexpr double kMostFilled = 0.3;  // of the samples that may be missing or spoilt

struct Knots {
  Eigen::VectorXd t, v;

  [[nodiscard]] double at(double time) const { return interpolate(t, v, time); }
};

/// The known values nearest to [begin, end) on either side.
template <class Values>
Knots knots_around(const Values& values, const Eigen::VectorXd& t_s, Index begin, Index end, int each_side) {
  std::vector<Index> rows;
  for (Index k = begin - 1; k >= 0 && std::ssize(rows) < each_side; --k) {
    if (std::isfinite(values(k))) rows.push_back(k);
  }
  std::ranges::reverse(rows);
  const auto wanted = std::ssize(rows) + each_side;
  for (Index k = end; k < values.size() && std::ssize(rows) < wanted; ++k) {
    if (std::isfinite(values(k))) rows.push_back(k);
  }
  return {t_s(rows), values(rows)};
}

/// Fills the missing numbers of one channel.
class Filler {
 public:
  Filler(CheckRoom& room, const Channel& channel) : room_(room), channel_(channel) {
    const bool q = channel.block == &room.log.q;
    const bool tau = channel.block == &room.log.tau;
    const auto drive = static_cast<std::size_t>(channel.drive);
    stale_ = q ? room.stale_positions[drive] : (tau ? room.stale_torques[drive] : 1);
    // Noise would swing a higher polynomial through torques; between updates at an even pace it cannot.
    each_side_ = channel.position ? 3 : (stale_ > 1 ? 2 : 1);
    longest_ = stale_ > 1 ? 3 * stale_ : room.longest_filled(room.grid.step_s);
  }

  void fill() {
    const auto values = channel_.values();
    for_each_gap(values, [&](Index begin, Index end) {
      if (end - begin == values.size()) {
        throw Error("the column holds no number", room_.where(0, channel_.name),
                    "record this drive, or give the column that holds its values");
      }
      fill_run(begin, end);
    });
  }
  /// Numbers that were missing in this channel alone.
  [[nodiscard]] const Tally& filled() const { return filled_; }

 private:
  void fill_run(Index begin, Index end) {
    auto values = channel_.block->col(channel_.drive);
    const Index n = values.size();
    const bool long_run = end - begin > longest_ || begin == 0 || end == n;
    const Knots knots = knots_around(values, room_.log.t_s, begin, end, long_run ? 1 : each_side_);
    // Judged before the values are there.
    const char mark = long_run ? Log::kLeftOut : mark_for(end - begin);
    for (Index k = begin; k < end; ++k) values(k) = knots.at(room_.log.t_s(k));
    if (stale_ > 1 && end - begin <= longest_) {
      // What was never measured is no loss; thinned out later. Only at the ends the update is missing.
      if (long_run && channel_.block == &room_.log.tau) room_.log.leave_torque_out(channel_.drive, begin, end);
      return;
    }
    const bool told =
        room_.log.is_filled(begin) || (!room_.log.line.empty() && room_.log.line[static_cast<std::size_t>(begin)] == 0);
    if (channel_.block == &room_.log.tau && long_run) {
      room_.log.leave_torque_out(channel_.drive, begin, end);
    } else if (channel_.block == &room_.log.q || channel_.block == &room_.log.tau) {
      for (Index k = begin; k < end; ++k) room_.mark_filled(k, mark);
    }
    if (told) return;
    filled_.add(begin, end - begin);
  }

  /// Is a run of this length filled as well as measured?
  char mark_for(Index length) {
    auto& known = marks_.at(static_cast<std::size_t>(std::min<Index>(length, static_cast<Index>(marks_.size()) - 1)));
    if (known != kUnknown) return known;
    if (noise_ < 0) {
      const ChannelQuality quality = measure_channel(channel_.values());
      noise_ = quality.noise;
      range_ = quality.travel;
    }
    const double share = channel_.position ? kShareOfPositions : kShareOfTorques;
    const double error = error_of_filling(length);
    known = error <= std::max(kNoiseRatio * noise_, share * range_) ? Log::kBridged : Log::kLeftOut;
    return known;
  }

  /// Root mean square of what the filling misses where the values are known, at the middle of a gap.
  [[nodiscard]] double error_of_filling(Index length) const {
    constexpr Index kTrials = 500;
    const auto values = channel_.values();
    const Index n = values.size();
    const Index margin = 4;
    double square = 0, count = 0;
    for (Index trial = 0; trial < kTrials; ++trial) {
      const Index begin = margin + trial * std::max<Index>(0, n - length - 2 * margin) / kTrials;
      const Index middle = begin + length / 2;
      if (middle + margin + length >= n || !std::isfinite(values(middle))) continue;
      const Knots knots = knots_around(values, room_.log.t_s, begin, begin + length, each_side_);
      const double miss = values(middle) - knots.at(room_.log.t_s(middle));
      square += miss * miss;
      count += 1.0;
    }
    return count > 20 ? std::sqrt(square / count) : 1e300;
  }

  static constexpr char kUnknown = 9;
  CheckRoom& room_;
  const Channel& channel_;
  int stale_ = 1;
  int each_side_ = 1;
  Index longest_ = 3;
  double noise_ = -1, range_ = 0;
  std::vector<char> marks_ = std::vector<char>(128, kUnknown);
  Tally filled_;
};

/// Drops rows at the ends that some drive's position could only be extrapolated to; stale channels may lack some.
void trim_ends(CheckRoom& room) {
  const Log& log = room.log;
  Index first = 0, last = log.samples();
  for (Index d = 0; d < log.drives(); ++d) {
    while (first < last && !std::isfinite(log.q(first, d))) ++first;
    while (last > first && !std::isfinite(log.q(last - 1, d))) --last;
  }
  if (first >= last || (first == 0 && last == log.samples())) return;
  room.log = rows_of(log, first, last);
  room.grid.start_s += static_cast<double>(first) * room.grid.step_s;
}

}  // namespace

void fill_missing_numbers(CheckRoom& room) {
  trim_ends(room);
  room.fresh_row = fresh_phase(room);
  const std::vector<Channel> channels = room.channels();
  std::vector<Tally> tallies;
  Index all = 0, columns = 0;
  for (const Channel& channel : channels) {
    Filler filler(room, channel);
    filler.fill();
    tallies.push_back(filler.filled());
    all += tallies.back().count;
    columns += tallies.back().count > 0 ? 1 : 0;
  }
  const bool each = columns <= kEachColumn;
  bool said = false;
  for (std::size_t k = 0; k < channels.size(); ++k) {
    if (tallies[k].count == 0) continue;
    const std::string more = !each                  ? fmt::format("; the first of {} in {} columns", all, columns)
                             : tallies[k].count > 1 ? fmt::format("; the first of {}", tallies[k].count)
                                                    : "";
    room.tell({.level = FindingLevel::mended,
               .key = "missing_numbers",
               .drive = static_cast<int>(channels[k].drive),
               .value = static_cast<double>(tallies[k].count),
               .unit = "rows",
               .text = room.where(tallies[k].first, channels[k].name) + ": no number, filled in" + more},
              each || !said);
    said = true;
  }
}

void refuse_too_many_filled(CheckRoom& room) {
  const Log& log = room.log;
  const auto spoilt = [](char mark) { return mark != Log::kMeasured; };
  const auto filled = std::ranges::count_if(log.filled, spoilt);
  const double share = static_cast<double>(filled) / static_cast<double>(log.samples());
  // One sample must be allowed in a log of any length.
  if (share > kMostFilled && filled > kLongestFilledRows) {
    const auto first = std::ranges::find_if(log.filled, spoilt) - log.filled.begin();
    throw UnusablePart(fmt::format("{:.2g} % of the samples are missing or spoilt, the first one here", 100.0 * share),
                       room.where(first), "look for lost packets or a loose encoder cable, and record again");
  }
}

}  // namespace deltadyn::checks
