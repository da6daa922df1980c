#include "recorded_time.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "deltadyn/io/csv.hpp"
#include "deltadyn/runtime/error.hpp"

#include "common_grid.hpp"
#include "header_words.hpp"
#include "recording/field.hpp"

namespace deltadyn {
namespace {

struct TimeUnit {
  double seconds;
  std::int64_t origin_ns;  ///< of the channel's origin
  std::string name;
};

std::string without_blanks(const std::string& name) {
  std::string plain = forms::lower(name);
  std::erase_if(plain, [](char c) { return c == ' ' || c == '\t' || c == '"'; });
  return plain;
}

/// How much a name looks like the time of the rows; 0 not at all.
int time_rank(const RecordedChannel& channel) {
  const NameAndUnit parts = split_unit(channel.name);
  const std::vector<std::string> words = words_of(parts.stem);
  const auto has = [&](std::initializer_list<const char*> any) {
    return std::ranges::find_first_of(words, any) != words.end();
  };
  if (has({"header"}) && has({"stamp"})) return 5;  // ROS: when it was measured, not when it was written down
  if (channel.name == "t_s") return 5;
  const bool named = has({"time", "timestamp", "stamp", "zeit", "zeitstempel", "uhrzeit", "clock", "elapsed",
                          "datetime", "seconds", "secs", "tick", "ticks"});
  const bool letter = words.size() == 1 && has({"t", "sec"});
  const bool unit = !channel.unit.empty() && !log_unit(channel.unit) && time_unit_s(channel.unit);
  if (named || letter) return unit || channel.clock ? 4 : 3;
  if (channel.clock) return 2;
  return unit ? 1 : 0;
}

/// A time goes on; a few repeated or swapped stamps are faults of the recorder, which the check names.
bool goes_on(const Eigen::VectorXd& values) {
  const Eigen::Index n = values.size();
  if (n < 2) return false;
  Eigen::Index back = 0, known = 0;
  double first = std::nan(""), last = first;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (std::isnan(values(i))) continue;
    if (known > 0 && values(i) < last) ++back;
    if (known++ == 0) first = values(i);
    last = values(i);
  }
  return known > 1 && last > first && 50 * back <= n;
}

double usual_step(const Eigen::VectorXd& values) {
  constexpr Eigen::Index kEnough = 20000;
  return usual_step_s(values.head(std::min(values.size(), kEnough)));
}

/// Seconds since 1970 are about 1.7e9 now; the same in ms, us and ns, and the ticks of 1601, have their own decades.
std::optional<TimeUnit> unit_of_epoch(double start) {
  const double years = start / (365.25 * 86400.0);
  for (const auto& [seconds, name] :
       {std::pair(1.0, "s"), std::pair(1e-3, "ms"), std::pair(1e-6, "us"), std::pair(1e-9, "ns")}) {
    if (years * seconds > 25.0 && years * seconds < 100.0) return TimeUnit{seconds, 0, name};
  }
  if (years * 1e-7 > 395.0 && years * 1e-7 < 470.0) return TimeUnit{1e-7, 0, "filetime"};
  return std::nullopt;
}

/// From the unit stated, or from the size of the numbers; nothing if both leave it open.
std::optional<TimeUnit> unit_of(const RecordedChannel& channel, const ColumnMap& map) {
  if (channel.clock) return TimeUnit{1.0, 0, "date"};
  if (map.tick_s) return TimeUnit{*map.tick_s, 0, "ticks"};
  const std::string stated = map.time_unit.empty() ? channel.unit : map.time_unit;
  if (const auto seconds = time_unit_s(stated)) return TimeUnit{*seconds, 0, stated};
  Eigen::Index first = 0;
  while (first + 1 < channel.values.size() && std::isnan(channel.values(first))) ++first;
  if (auto epoch = unit_of_epoch(static_cast<double>(channel.origin) + channel.values(first))) return epoch;
  // Drives record at 7 Hz to 100 kHz: such steps are seconds. A step of 1 may be a ms or a count, so it stays open.
  const double step = usual_step(channel.values);
  if (step >= 1e-5 && step < 0.15) return TimeUnit{1.0, 0, "s"};
  return std::nullopt;
}

/// Without names, a first column of even steps can be nothing else.
bool is_even(const Eigen::VectorXd& values) {
  const double step = usual_step(values);
  const Eigen::Index n = values.size();
  return step > 0 &&
         ((values.tail(n - 1) - values.head(n - 1)).array() - step).abs().maxCoeff<Eigen::PropagateNaN>() < 1e-2 * step;
}

const RecordedChannel* guess_time(const Recording& recording) {
  const RecordedChannel* best = nullptr;
  int best_rank = 0;
  for (const RecordedChannel& channel : recording.channels) {
    const int rank = time_rank(channel);
    if (rank > best_rank && channel.text_line == 0 && goes_on(channel.values)) {
      best = &channel;
      best_rank = rank;
    }
  }
  if (best == nullptr && recording.headerless && !recording.channels.empty() && is_even(recording.channels[0].values))
    return &recording.channels[0];
  return best;
}

void take_rate(Timeline& timeline, double rate_hz) {
  const auto last = static_cast<double>(timeline.rows() - 1);
  timeline.name = "rate_hz";
  timeline.unit = "Hz";
  timeline.origin_ns = 0;
  timeline.t_s = Eigen::VectorXd::LinSpaced(timeline.rows(), 0.0, last / rate_hz);
}

/// Drives record at 2 Hz to 200 kHz; other steps are those of a wrong unit.
void refuse_step(const Recording& recording, const Timeline& timeline) {
  const double step_s = usual_step(timeline.t_s);
  if (step_s >= 5e-6 && step_s <= 0.5) return;
  throw Error(fmt::format("by the time column '{}' [{}] the rows are {:.4g} s apart, which no recorder of a drive does",
                          timeline.name, timeline.unit, step_s),
              recording.file,
              "name the time in seconds t_s; or give delta-log import --time-unit, or unit below [time] in a column "
              "map (--map)");
}

/// Fills in a time line from a column with the stamps of its rows.
void take_stamps(const Recording& recording, const RecordedChannel& channel, const TimeUnit& unit, Timeline& timeline) {
  timeline.name = channel.name;
  timeline.unit = unit.name;
  timeline.t_s = unit.seconds * channel.values;
  if (usual_step(timeline.t_s) > 0) refuse_step(recording, timeline);
  const bool filetime = unit.name == "filetime" && channel.origin > forms::kFileTimeToUnixTicks;
  const std::int64_t origin = filetime ? channel.origin - forms::kFileTimeToUnixTicks : channel.origin;
  const double unit_ns = 1e9 * unit.seconds;
  // Stamps of other centuries have no date; their differences are all that counts.
  const bool dated = unit_ns * std::abs(static_cast<double>(origin)) < 9e18;
  timeline.origin_ns = channel.clock ? channel.origin : (dated ? std::llround(unit_ns) * origin : 0);
}

void take_column(Recording& recording, const RecordedChannel& channel, ColumnMap& map) {
  const auto unit = unit_of(channel, map);
  map.time_source = channel.name;  // also for the map that the user mends
  if (!unit) {
    throw Error(fmt::format("the unit of the time column '{}' is not known; its usual step is {:.6g}", channel.name,
                            usual_step(channel.values)),
                recording.file,
                "name it time_ms, time_us or t_s; or give delta-log import --time-unit, or --rate-hz if it only counts "
                "rows; or unit or rate_hz below [time] in a column map (--map)");
  }
  take_stamps(recording, channel, *unit, recording.timelines[channel.timeline]);
  if (!channel.clock && !map.tick_s) map.time_unit = unit->name;
}

/// A time column among others of one table.
struct TimeColumn {
  std::size_t index;  ///< of the channel
  TimeUnit unit;
  double step_s;
  Eigen::Index stamps;
};

std::vector<TimeColumn> time_columns(const Recording& recording, const ColumnMap& map) {
  std::vector<TimeColumn> found;
  for (std::size_t k = 0; k < recording.channels.size(); ++k) {
    const RecordedChannel& channel = recording.channels[k];
    if (time_rank(channel) < 3 || channel.text_line > 0 || !goes_on(channel.values)) continue;
    if (const auto unit = unit_of(channel, map)) {
      found.push_back(
          {k, *unit, unit->seconds * usual_step(channel.values), (!channel.values.array().isNaN()).count()});
    }
  }
  return found;
}

/// Whether two time columns are those of groups with rows of their own, and not two clocks for the same rows (ROS:
/// measured and written down): another rate, fewer stamps, or the same name with other stamps.
bool are_groups(const Recording& recording, const TimeColumn& a, const TimeColumn& b) {
  const RecordedChannel& one = recording.channels[a.index];
  const RecordedChannel& other = recording.channels[b.index];
  const bool other_rate = std::abs(a.step_s - b.step_s) > 0.1 * std::min(a.step_s, b.step_s);
  const bool fewer =
      std::abs(static_cast<double>(a.stamps - b.stamps)) > 0.01 * static_cast<double>(std::max(a.stamps, b.stamps));
  const auto plain = [](const RecordedChannel& channel) {
    return without_blanks(channel.name.substr(0, channel.name.find(" (")));
  };
  const bool other_stamps = !((one.values - other.values).cwiseAbs().maxCoeff() <= 1e-3 * usual_step(one.values));
  return other_rate || fewer || (plain(one) == plain(other) && other_stamps);
}

/// Several time columns in a text, each with a rate of its own for the columns to its right: every one becomes a time
/// line. Returns whether there were such groups.
bool split_groups(Recording& recording, const ColumnMap& map) {
  if (recording.timelines.size() != 1) return false;
  const std::vector<TimeColumn> times = time_columns(recording, map);
  bool groups = false;
  for (std::size_t k = 1; k < times.size(); ++k) groups = groups || are_groups(recording, times[0], times[k]);
  if (!groups) return false;
  const Timeline whole = recording.timelines[0];
  recording.timelines.clear();
  for (std::size_t group = 0; group < times.size(); ++group) {
    const std::size_t begin = group == 0 ? 0 : times[group].index;
    const std::size_t end = group + 1 < times.size() ? times[group + 1].index : recording.channels.size();
    const Eigen::VectorXd stamps = recording.channels[times[group].index].values;
    std::vector<Eigen::Index> rows;
    for (Eigen::Index row = 0; row < stamps.size(); ++row) {
      if (!std::isnan(stamps(row))) rows.push_back(row);
    }
    Timeline timeline;
    for (const Eigen::Index row : rows) timeline.line.push_back(whole.line[static_cast<std::size_t>(row)]);
    for (std::size_t k = begin; k < end; ++k) {
      recording.channels[k].values = recording.channels[k].values(rows).eval();
      recording.channels[k].timeline = group;
    }
    take_stamps(recording, recording.channels[times[group].index], times[group].unit, timeline);
    recording.timelines.push_back(std::move(timeline));
  }
  recording.form += fmt::format(", {} groups of columns with time columns of their own", times.size());
  return true;
}

}  // namespace

std::string list_channels(const Recording& recording) {
  constexpr std::size_t kMost = 30;
  std::vector<std::string> names;
  for (const RecordedChannel& channel : recording.channels) {
    if (names.size() < kMost) names.push_back(channel.name);
  }
  const std::size_t more = recording.channels.size() - names.size();
  return fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

const RecordedChannel& find_channel(const Recording& recording, const std::string& source, const std::string& where) {
  const auto unique = [&](auto fits) -> const RecordedChannel* {
    const RecordedChannel* found = nullptr;
    for (const RecordedChannel& channel : recording.channels) {
      if (!fits(channel)) continue;
      if (found != nullptr) return nullptr;
      found = &channel;
    }
    return found;
  };
  const std::string plain = without_blanks(source);
  for (const auto* found :
       {unique([&](const RecordedChannel& c) { return c.name == source; }),
        unique([&](const RecordedChannel& c) { return std::ranges::find(c.aliases, source) != c.aliases.end(); }),
        unique([&](const RecordedChannel& c) { return without_blanks(c.name) == plain; }),
        unique([&](const RecordedChannel& c) { return without_blanks(split_unit(c.name).stem) == plain; })}) {
    if (found != nullptr) return *found;
  }
  throw Error(fmt::format("there is no column '{}' in {}; it has {}", source, recording.file, list_channels(recording)),
              where, "correct source: one of these names, or the number of the column from 1");
}

void resolve_time(Recording& recording, ColumnMap& map) {
  const bool open = std::ranges::any_of(recording.timelines, [](const Timeline& t) { return t.t_s.size() == 0; });
  for (const Timeline& timeline : recording.timelines) {
    if (timeline.rows() < 2)
      throw Error("the file holds a header but no data rows", recording.file, "check that the recording is complete");
  }
  if (map.rate_hz) {
    for (Timeline& timeline : recording.timelines) {
      if (timeline.t_s.size() == 0) take_rate(timeline, *map.rate_hz);
    }
    return;
  }
  if (open && split_groups(recording, map)) return;
  if (!map.time_source.empty()) {
    const RecordedChannel& channel =
        find_channel(recording, map.time_source, map.file.empty() ? "--time-column" : map.file);
    if (channel.text_line > 0) {
      throw Error(fmt::format("'{}' is neither a number nor a date", channel.text),
                  place(recording.file, channel.text_line, channel.name),
                  "give another time column, or the rate with --rate-hz");
    }
    take_column(recording, channel, map);
    return;
  }
  if (!open) return;
  const RecordedChannel* channel = guess_time(recording);
  if (channel == nullptr) {
    throw Error(
        fmt::format("the column t_s is missing; the file has {}, and none of them is a time that goes on",
                    list_channels(recording)),
        recording.file,
        "name the time column t_s; or give delta-log import --time-column, or --rate-hz of the recorder if there is "
        "none; or source or rate_hz below [time] in a column map (--map)");
  }
  take_column(recording, *channel, map);
}

}  // namespace deltadyn
