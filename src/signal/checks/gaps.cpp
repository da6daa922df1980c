/// \file
/// Long gaps in time, and rows without positions: the log falls into parts.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/statistics.hpp"

#include "checks.hpp"
#include "sample_stretches.hpp"

namespace deltadyn::checks {
namespace {

constexpr double kLargestSampleTime = 0.2;   // s; slower sampling shows nothing of the dynamics
constexpr double kUnevenShare = 0.1;         // of the steps away from the usual one: then a longer step is no lost row
constexpr double kLongestUnevenStep = 0.03;  // s; within it a drive's motion is still a cubic
// s; the shorter a part, the larger the share that the filters lose at its ends
constexpr double kShortParts[] = {4.0, 2.0, 1.0};
constexpr double kEnough = 0.8;  // of the recorded time has to stay in the parts that are used

/// A longer step than this is a gap.
double longest_step(const CheckRoom& room, double usual, const std::vector<double>& steps) {
  const double allowed = (static_cast<double>(room.longest_filled(usual)) + 1.5) * usual;
  double uneven = 0;
  for (const double step : steps) {
    const double multiple = step / usual;
    if (std::abs(multiple - std::max(1.0, std::round(multiple))) > 0.2) uneven += 1.0;
  }
  return uneven > kUnevenShare * static_cast<double>(steps.size()) ? std::max(allowed, kLongestUnevenStep) : allowed;
}

/// First rows of the parts, and the end.
std::vector<Index> borders_of(CheckRoom& room, double longest, Tally& gaps) {
  const Eigen::VectorXd& t = room.log.t_s;
  std::vector<Index> borders{0};
  for (Index i = 1; i < t.size(); ++i) {
    const bool recording = std::ranges::binary_search(room.recordings, i);
    if (!recording && t(i) - t(i - 1) <= longest) continue;
    if (!recording) gaps.add(i);
    borders.push_back(i);
  }
  borders.push_back(t.size());
  return borders;
}

/// One finding for all drives, which mostly are blind together.
void tell_blind_rows(const CheckRoom& room, const std::vector<Tally>& tallies) {
  Tally most;
  std::string names;
  int drive = -1;
  for (const Channel& channel : room.channels()) {
    if (channel.block != &room.log.q) continue;
    const Tally& tally = tallies[static_cast<std::size_t>(channel.drive)];
    if (tally.count == 0) continue;
    if (tally.count == room.log.samples()) {
      throw Error("the column holds no number", room.where(0, channel.name),
                  "record this drive's position, or correct the column");
    }
    names += (names.empty() ? "" : ", ") + channel.name;
    drive = most.count == 0 ? static_cast<int>(channel.drive) : -1;
    if (tally.count > most.count) most = tally;
  }
  if (most.count == 0) return;
  room.tell(
      FindingLevel::mended, "blind_rows", most.first, names, drive, static_cast<double>(most.count), "rows",
      fmt::format("no number for longer than can be filled, or at an end, in {} samples: these rows are left away",
                  most.count));
}

}  // namespace

void drop_blind_rows(CheckRoom& room) {
  Log& log = room.log;
  const Index n = log.samples();
  const double usual = lower_median(steps_of(log.t_s));
  std::vector<char> blind(static_cast<std::size_t>(n), 0);
  std::vector<Tally> tallies(static_cast<std::size_t>(log.drives()));
  for (Index d = 0; d < log.drives(); ++d) {
    const int stale = room.stale_positions[static_cast<std::size_t>(d)];
    const Index longest = stale > 1 ? 3 * stale : room.longest_filled(usual);
    for_each_gap(log.q.col(d), [&](Index begin, Index end) {
      // At the ends there is nothing to fill from.
      if (end - begin <= longest && begin != 0 && end != n) return;
      std::fill(blind.begin() + begin, blind.begin() + end, 1);
      if (stale <= 1) tallies[static_cast<std::size_t>(d)].add(begin, end - begin);
    });
  }
  std::vector<Index> rows;
  std::vector<Index> recordings;
  bool new_recording = false;
  for (Index i = 0; i < n; ++i) {
    new_recording = new_recording || std::ranges::binary_search(room.recordings, i);
    if (blind[static_cast<std::size_t>(i)] != 0) continue;
    if (new_recording && !rows.empty()) recordings.push_back(static_cast<Index>(rows.size()));
    new_recording = false;
    rows.push_back(i);
  }
  if (static_cast<Index>(rows.size()) == n) return;
  tell_blind_rows(room, tallies);
  room.keep(rows);
  room.recordings = std::move(recordings);
  check_length(room);
}

std::vector<Log> split(CheckRoom& room) {
  const Log& log = room.log;
  const std::vector<double> steps = steps_of(log.t_s);
  const double usual = lower_median(steps);
  if (usual > kLargestSampleTime) {
    throw Error(fmt::format("the samples are {:.4g} s apart", usual), room.where(0, "t_s"),
                "give the time in seconds; record with at least 100 samples a second");
  }
  Tally gaps;
  const std::vector<Index> borders = borders_of(room, longest_step(room, usual, steps), gaps);
  if (borders.size() == 2) return {log};

  const auto seconds = [&](std::size_t k) { return log.t_s(borders[k + 1] - 1) - log.t_s(borders[k]); };
  const auto time_in_parts_of = [&](double least) {
    double sum = 0;
    for (std::size_t k = 0; k + 1 < borders.size(); ++k) sum += seconds(k) >= least ? seconds(k) : 0.0;
    return sum;
  };
  double shortest = kShortestDuration_s;
  for (const double least : kShortParts) {
    if (least <= shortest || time_in_parts_of(least) < kEnough * time_in_parts_of(0)) continue;
    shortest = least;
    break;
  }
  if (gaps.count > 0) {
    const std::string size = fmt::format("a gap of {:.4g} s in the time stamps, where the samples are {:.4g} s apart",
                                         log.t_s(gaps.first) - log.t_s(gaps.first - 1), usual);
    room.tell(FindingLevel::mended, "gaps", gaps.first, "t_s", -1, static_cast<double>(gaps.count), "",
              size + (gaps.count == 1 ? ": the log is used as two parts"
                                      : fmt::format(", the first of {}: the log is used in parts", gaps.count)));
  }
  std::vector<Log> parts;
  Tally dropped;
  for (std::size_t k = 0; k + 1 < borders.size(); ++k) {
    const Index samples = borders[k + 1] - borders[k];
    if (samples < kFewestSamples || seconds(k) < shortest) {
      dropped.add(borders[k]);
      continue;
    }
    parts.push_back(rows_of(log, borders[k], borders[k + 1]));
    parts.back().part = static_cast<int>(parts.size());
    parts.back().notes.clear();
    parts.back().findings.clear();
  }
  if (parts.empty()) {
    throw Error(fmt::format("gaps in the time stamps leave no part of {:.3g} s, the first one here", shortest),
                room.where(borders[1], "t_s"), "look for lost packets, and record again without gaps");
  }
  if (dropped.count > 0) {
    room.tell(FindingLevel::warning, "short_parts", dropped.first, "", -1, static_cast<double>(dropped.count), "",
              fmt::format("{} part(s) between gaps are shorter than {:.3g} s and not used, the first begins here",
                          dropped.count, shortest),
              "look for lost packets, or record again without gaps if these parts are needed");
  }
  parts.front().notes = log.notes;
  parts.front().findings = log.findings;
  return parts;
}

}  // namespace deltadyn::checks
