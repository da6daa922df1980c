#include "deltadyn/io/import_log.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <set>

#include "deltadyn/io/csv.hpp"
#include "deltadyn/runtime/error.hpp"

#include "common_grid.hpp"
#include "counter_turns.hpp"
#include "guess_columns.hpp"
#include "header_words.hpp"
#include "recorded_time.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;

/// More empty fields than this are no lost samples: the channel has a rate of its own.
constexpr double kOwnRateShare = 0.2;

/// The recordings as one. Each keeps its time lines; stamps since 1970 join by themselves, others count from a common
/// zero.
Recording merged(std::vector<Recording> recordings) {
  Recording all = std::move(recordings.front());
  for (std::size_t k = 1; k < recordings.size(); ++k) {
    Recording& next = recordings[k];
    std::set<std::string> names;
    for (const RecordedChannel& channel : all.channels) names.insert(channel.name);
    for (const RecordedChannel& channel : next.channels) {
      const bool is_time = next.timelines[channel.timeline].name == channel.name;
      if (is_time || names.count(channel.name) == 0) continue;
      throw Error(
          fmt::format("the column {} is in {} and in {}: these are recordings of their own, not columns of one",
                      channel.name, all.file, next.file),
          next.file,
          "import them one after the other, and give delta-identify all the logs; if each file holds one drive of one "
          "motion, let the column names carry its number");
    }
    const std::size_t shift = all.timelines.size();
    for (Timeline& timeline : next.timelines) all.timelines.push_back(std::move(timeline));
    for (RecordedChannel& channel : next.channels) {
      if (next.timelines[channel.timeline].name == channel.name) continue;
      channel.timeline += shift;
      all.channels.push_back(std::move(channel));
    }
    if (next.form != all.form) all.form += " and " + next.form;
    all.notes.insert(all.notes.end(), next.notes.begin(), next.notes.end());
    all.notes.push_back(
        all.timelines[0].origin_ns == 0
            ? fmt::format("{} and {} were joined; their times are taken to have the same zero", all.file, next.file)
            : fmt::format("{} and {} were joined by their stamps", all.file, next.file));
  }
  return all;
}

/// A channel ready for the grid.
struct Prepared {
  const ChannelMap* map;
  const RecordedChannel* channel;
  SampledChannel series;  ///< empty if `whole`
  bool whole = false;     ///< its rows are those of its time line
  TakenChannel taken;
};

/// Picks the rows of a channel that are samples of its own: not those left empty, and not those filled up with repeats.
std::vector<Index> own_rows(const RecordedChannel& channel, const Timeline& timeline) {
  std::vector<Index> rows;
  const Index n = channel.values.size();
  const double step = channel.sample_time_s > 0 ? usual_step_s(timeline.t_s) : 0.0;
  if (step > 0 && channel.sample_time_s > 1.5 * step) {
    const auto factor = static_cast<Index>(std::lround(channel.sample_time_s / step));
    for (Index i = first_of_repeats(channel.values, factor); i < n; i += factor) {
      if (!std::isnan(channel.values(i))) rows.push_back(i);
    }
    return rows;
  }
  const auto empty = static_cast<double>(channel.values.array().isNaN().count());
  if (empty <= kOwnRateShare * static_cast<double>(n)) return rows;
  for (Index i = 0; i < n; ++i) {
    if (!std::isnan(channel.values(i))) rows.push_back(i);
  }
  return rows;
}

class Builder {
 public:
  Builder(const Recording& recording, const ColumnMap& map, const RobotDescription& robot)
      : recording_(recording), map_(map), robot_(robot) {}

  ImportedLog build() {
    ImportedLog result;
    result.map = map_;
    result.log.file = recording_.file;
    result.log.notes = recording_.notes;
    for (const ChannelMap& channel : map_.channels) {
      if (used(channel)) {
        prepare(channel);
      } else {
        result.log.notes.push_back(fmt::format("{}: not every drive has a {}, so '{}' is not used", recording_.file,
                                               word_of(channel.quantity), channel.source));
      }
    }
    result.log.notes.insert(result.log.notes.end(), remarks_.begin(), remarks_.end());
    choose_grid();
    fill(result);
    cut_to_common_span(result.log);
    return result;
  }

 private:
  /// A derivative counts only if every drive has it, as in a log of these tools.
  [[nodiscard]] bool used(const ChannelMap& channel) const {
    for (int drive = 1; drive <= robot_.drives(); ++drive) {
      if (map_.find(channel.quantity, drive) == nullptr) return false;
    }
    return true;
  }

  [[nodiscard]] std::string where(const ChannelMap& channel) const {
    return map_.file.empty() || channel.line == 0 ? place(recording_.file, 0, channel.source)
                                                  : place(map_.file, channel.line);
  }

  void prepare(const ChannelMap& map) {
    const RecordedChannel& channel = find_channel(recording_, map.source, where(map));
    if (channel.text_line > 0) {
      throw Error(fmt::format("'{}' is not a number", channel.text),
                  place(recording_.file, channel.text_line, channel.name),
                  "remove the row or correct the value; leave the field empty if it is not known");
    }
    Prepared one{&map, &channel, {}, false, {}};
    one.taken.map = map;
    one.taken.map.source = channel.name;
    one.taken.factor = map.sign * si_factor(map, robot_.kind_of_drive(map.drive - 1), where(map));
    const Timeline& timeline = recording_.timelines[channel.timeline];
    const std::vector<Index> rows = own_rows(channel, timeline);
    one.whole = rows.empty() && map.delay_s == 0;
    if (!one.whole) one.series = series_of(channel.values, timeline, rows, map.delay_s);
    const Eigen::VectorXd& stamps = one.whole ? timeline.t_s : one.series.t_s;
    one.taken.step_s = usual_step_s(stamps);
    one.taken.rate_hz = mean_rate_hz(stamps);
    prepared_.push_back(std::move(one));
    if (!channel.remark.empty())
      remarks_.push_back(fmt::format("{}: '{}': {}", recording_.file, channel.name, channel.remark));
  }

  /// Stamps from the first row of the first time line on.
  [[nodiscard]] double shift_of(const Timeline& timeline) const {
    return static_cast<double>(1e-9L * (static_cast<long double>(timeline.origin_ns) -
                                        static_cast<long double>(recording_.timelines[0].origin_ns)));
  }

  [[nodiscard]] SampledChannel series_of(const Eigen::VectorXd& values, const Timeline& timeline,
                                         const std::vector<Index>& rows, double delay_s) const {
    const Index n = rows.empty() ? values.size() : static_cast<Index>(rows.size());
    SampledChannel series{Eigen::VectorXd(n), Eigen::VectorXd(n)};
    const double shift = shift_of(timeline) - delay_s;
    Index count = 0;
    for (Index k = 0; k < n; ++k) {
      const Index row = rows.empty() ? k : rows[static_cast<std::size_t>(k)];
      const double t = timeline.t_s(row) + shift;
      if (std::isnan(values(row)) || std::isnan(t)) continue;  // a hole, as a lost row
      // Stamps must go on for interpolation: repeated ones are left out, those that go back are refused.
      if (count > 0 && t < series.t_s(count - 1)) {
        throw Error("the time stamps decrease",
                    place(recording_.file, timeline.line[static_cast<std::size_t>(row)], timeline.name),
                    "sort the rows by time, or put each recording into its own file");
      }
      if (count > 0 && t == series.t_s(count - 1)) continue;
      series.t_s(count) = t;
      series.values(count++) = values(row);
    }
    series.t_s.conservativeResize(count);
    series.values.conservativeResize(count);
    return series;
  }

  /// The stamps that most positions have; of two alike the faster, as then nothing recorded is lost.
  void choose_grid() {
    std::map<std::pair<std::size_t, Index>, int> votes;
    const auto key = [&](const Prepared& one) {
      return std::pair(one.whole ? one.channel->timeline : recording_.timelines.size(),
                       one.whole ? Index(0) : one.series.t_s.size());
    };
    for (const Prepared& one : prepared_) {
      if (one.map->quantity == Quantity::position) ++votes[key(one)];
    }
    const Prepared* best = nullptr;
    for (const Prepared& one : prepared_) {
      if (one.map->quantity != Quantity::position) continue;
      const int more = best == nullptr ? 1 : votes[key(one)] - votes[key(*best)];
      if (more > 0 || (more == 0 && one.taken.step_s < 0.999 * best->taken.step_s)) best = &one;
    }
    grid_of_ = best;
    const Timeline& timeline = recording_.timelines[best->channel->timeline];
    if (best->whole) {
      grid_s_ = timeline.t_s.array() + shift_of(timeline);
      grid_line_ = timeline.line;
    } else {
      grid_s_ = best->series.t_s;
      grid_line_.assign(static_cast<std::size_t>(grid_s_.size()), 0);
    }
  }

  [[nodiscard]] bool on_grid(const Prepared& one) const {
    if (!one.whole || !grid_of_->whole)
      return !one.whole && one.series.t_s.size() == grid_s_.size() && one.series.t_s == grid_s_;
    if (one.channel->timeline == grid_of_->channel->timeline) return true;
    // TwinCAT may write a time column for each channel; the same stamps are the same rows.
    const Timeline& timeline = recording_.timelines[one.channel->timeline];
    if (timeline.rows() != grid_s_.size()) return false;
    return (timeline.t_s.array() + shift_of(timeline) - grid_s_.array()).abs().maxCoeff() <= 1e-6 * one.taken.step_s;
  }

  /// Recorded numbers on the grid, jumps of an encoder's range taken out before anything is interpolated.
  [[nodiscard]] Eigen::VectorXd values_on_grid(Prepared& one, std::vector<std::string>& notes) const {
    Eigen::VectorXd values = one.whole ? one.channel->values : one.series.values;
    if (one.channel->origin != 0) values.array() += static_cast<double>(one.channel->origin);
    const bool same = on_grid(one);
    if (one.map->quantity == Quantity::position) {
      const auto drive = static_cast<std::size_t>(one.map->drive - 1);
      const std::string said = settle_counter(values, *one.map, one.taken.factor * one.map->scale,
                                              robot_.kind_of_drive(one.map->drive - 1), robot_.limits[drive]);
      if (!said.empty()) notes.push_back(fmt::format("{}: '{}': {}", recording_.file, one.channel->name, said));
    }
    if (same) {
      one.taken.how = "as recorded";
      return values;
    }
    const Timeline& timeline = recording_.timelines[one.channel->timeline];
    const SampledChannel series =
        one.whole ? series_of(values, timeline, {}, 0.0) : SampledChannel{one.series.t_s, values};
    double low_pass_hz = 0;
    Eigen::VectorXd result = onto_grid(series, grid_s_, low_pass_hz);
    one.taken.how = low_pass_hz > 0
                        ? fmt::format("zero-phase low pass of {:.4g} Hz, then cubic interpolation", low_pass_hz)
                        : "cubic interpolation";
    if (one.map->delay_s != 0) one.taken.how += fmt::format(", {:.4g} ms earlier", 1e3 * one.map->delay_s);
    return result;
  }

  void fill(ImportedLog& result) {
    Log& log = result.log;
    const Index n = grid_s_.size();
    log.t_s = grid_s_;
    log.line = grid_line_;
    result.step_s = usual_step_s(grid_s_);
    result.time_name = recording_.timelines[grid_of_->channel->timeline].name;
    result.time_unit = recording_.timelines[grid_of_->channel->timeline].unit;
    for (Prepared& one : prepared_) {
      static constexpr Eigen::MatrixXd Log::*kBlocks[] = {&Log::q, &Log::qd, &Log::qdd, &Log::tau};
      Eigen::MatrixXd& block = log.*kBlocks[static_cast<std::size_t>(one.map->quantity)];
      if (block.size() == 0) block.setConstant(n, robot_.drives(), std::nan(""));
      const Eigen::VectorXd values = values_on_grid(one, log.notes);
      block.col(one.map->drive - 1) = one.taken.factor * (one.map->scale * values.array() + one.map->offset);
      result.taken.push_back(one.taken);
    }
  }

  /// Rows at the ends that not every channel reaches are left out; holes inside stay, the check of the log deals with
  /// them.
  void cut_to_common_span(Log& log) const {
    const Index n = log.samples();
    const auto complete = [&](Index row) {
      for (const Eigen::MatrixXd* block : {&log.q, &log.qd, &log.qdd, &log.tau}) {
        if (block->size() > 0 && block->row(row).array().isNaN().any()) return false;
      }
      return true;
    };
    const bool all_on_grid =
        std::ranges::all_of(prepared_, [](const Prepared& one) { return one.taken.how == "as recorded"; });
    Index begin = 0, end = n;
    if (!all_on_grid) {
      while (begin < end && !complete(begin)) ++begin;
      while (end > begin && !complete(end - 1)) --end;
    }
    if (end - begin < 2) {
      throw Error("the channels do not overlap in time", log.file,
                  "check that they were recorded together, and the units of their times");
    }
    if (begin > 0 || end < n) {
      log.notes.push_back(
          fmt::format("{}: {} rows at the beginning and {} at the end are left out, which not every channel reaches",
                      log.file, begin, n - end));
      for (Eigen::MatrixXd* block : {&log.q, &log.qd, &log.qdd, &log.tau}) {
        if (block->size() > 0) *block = block->middleRows(begin, end - begin).eval();
      }
      log.t_s = log.t_s.segment(begin, end - begin).eval();
      log.line = std::vector<long>(log.line.begin() + begin, log.line.begin() + end);
    }
    if (!std::isnan(log.t_s(0))) log.t_s.array() -= log.t_s(0);
  }

  const Recording& recording_;
  const ColumnMap& map_;
  const RobotDescription& robot_;
  std::vector<Prepared> prepared_;
  std::vector<std::string> remarks_;
  const Prepared* grid_of_ = nullptr;
  Eigen::VectorXd grid_s_;
  std::vector<long> grid_line_;
};

/// What was taken for what, for the notes of a log: one line a fact.
std::string what_was_taken(const ImportedLog& result, const Recording& recording, const RobotDescription& robot) {
  std::vector<std::string> parts;
  for (const TakenChannel& taken : result.taken) {
    parts.push_back(fmt::format("{} from '{}' [{}]{}", contract_name(robot, taken.map.drive - 1, taken.map.quantity),
                                taken.map.source, taken.map.unit, taken.how == "as recorded" ? "" : ", " + taken.how));
  }
  return fmt::format("{}: read as {}; time from '{}' [{}]\n  {}", recording.file, recording.form, result.time_name,
                     result.time_unit, fmt::join(parts, "\n  "));
}

}  // namespace

LogImport::LogImport(const std::vector<std::string>& files, const RobotDescription& robot, ImportOptions options)
    : robot_(robot), options_(std::move(options)) {
  options_.defaults.validate(robot.drives());
  if (!options_.map_file.empty()) map_ = read_column_map(options_.map_file, robot);
  const MapDefaults& defaults = options_.defaults;
  if (!defaults.time_source.empty()) map_.time_source = defaults.time_source;
  if (!defaults.time_unit.empty()) map_.time_unit = defaults.time_unit;
  if (!defaults.topic.empty()) map_.topic = defaults.topic;
  if (defaults.rate_hz) {
    map_.rate_hz = defaults.rate_hz;
    map_.time_source.clear();
  }
  std::vector<Recording> recordings;
  ColumnMap found = map_;
  for (const std::string& file : files) {
    recordings.push_back(read_recording(file, map_.topic));
    ColumnMap of_file = map_;  // each file may name its time otherwise
    try {
      resolve_time(recordings.back(), of_file);
    } catch (const Error& e) {
      open_.push_back(e);
    }
    if (recordings.size() == 1) found = of_file;
  }
  map_ = found;
  recording_ = merged(std::move(recordings));
  const bool nameless = recording_.headerless && map_.channels.empty();
  if (nameless) {
    open_.clear();  // the one cause of all that is open
    open_.emplace_back(
        "the header line is missing: the first line holds numbers only", place(recording_.file, 1),
        "add a first line with the column names; or write a column map (delta-log import --map-out map.toml begins "
        "one) with the numbers of the columns as source,\n"
        "    [time]\n    source = 1        # or rate_hz = 1000\n    unit = \"s\"\n    [[channel]]\n    drive = 1\n    "
        "quantity = \"position\"\n    source = 2\n"
        "    unit = \"rad\"");
  }
  for (const Quantity quantity : {Quantity::position, Quantity::velocity, Quantity::acceleration, Quantity::torque}) {
    if (nameless || map_.has(quantity)) continue;
    const bool needed = quantity == Quantity::position ||
                        (quantity == Quantity::torque ? options_.need_torque : options_.need_derivatives);
    const auto open = guess_channels(recording_, robot_, quantity, defaults, map_, recording_.notes);
    if (open && needed) open_.push_back(*open);
    note_joints_beyond(quantity);
    const ChannelMap* guessed = map_.find(quantity, 1);
    if (guessed != nullptr && read_header_words(guessed->source, "").origin == Origin::commanded) {
      recording_.notes.push_back(
          fmt::format("{}: '{}' is a commanded {} by its name; it is taken, as no measured one is there",
                      recording_.file, guessed->source, word_of(quantity)));
    }
  }
  for (ChannelMap& channel : map_.channels) {
    if (!channel.unit.empty()) continue;
    // A map without a unit leaves it to the recording, and last to SI.
    const RecordedChannel& recorded = find_channel(recording_, channel.source, map_.file);
    const auto known = log_unit(recorded.unit);
    channel.unit = known && known->quantity == channel.quantity
                       ? recorded.unit
                       : customary_unit("/", channel.quantity, robot_.kind_of_drive(channel.drive - 1));
  }
  defaults.apply(map_);
}

ImportedLog LogImport::log() const {
  if (!open_.empty()) throw open_.front();
  const auto demand = [&](Quantity quantity) {
    for (int drive = 1; drive <= robot_.drives(); ++drive) {
      if (map_.find(quantity, drive) != nullptr) continue;
      throw Error(fmt::format("the map has no {} of drive {}; the file has {}", word_of(quantity), drive,
                              list_channels(recording_)),
                  map_.file,
                  "add it to the map:\n" + to_toml(ChannelMap{.drive = drive, .quantity = quantity, .source = "NAME"}));
    }
  };
  demand(Quantity::position);
  if (options_.need_torque) demand(Quantity::torque);
  if (options_.need_derivatives) {
    demand(Quantity::velocity);
    demand(Quantity::acceleration);
  }
  ImportedLog result = Builder(recording_, map_, robot_).build();
  result.log.notes.insert(result.log.notes.begin(), what_was_taken(result, recording_, robot_));
  return result;
}

}  // namespace deltadyn
