#pragma once

/// \file
/// `delta-log import`: a log of these tools from what drives and recorders export.

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <optional>
#include <string>
#include <vector>

#include "deltadyn/io/import_log.hpp"
#include "deltadyn/io/log_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/signal/log_columns.hpp"

#include "tool_support.hpp"

namespace deltadyn::tools {

class Import {
 public:
  void add_to(CLI::App& app, ToolRun& run) {
    CLI::App& c =
        *app.add_subcommand("import",
                            "A log of these tools from what drives and recorders export: delimited text of any kind, "
                            "TwinCAT Scope, LinuxCNC halscope, UR "
                            "RTDE, PlotJuggler and ROS CSV, MATLAB matrices, rosbag2 (.db3). The form is recognised, "
                            "columns are guessed from their names; "
                            "a column map or the flags say what names do not.");
    set_example(
        c,
        "delta-log import export.csv --robot robot.urdf --map-out map.toml -o log.csv   # writes the guess\n"
        "  delta-log import export.csv --robot robot.urdf --map map.toml -o log.csv       # mended and used again\n"
        "  delta-log import trace.csv --robot robot.urdf --rate-hz 4000 --torque-unit permille --rated-torque 1.27 "
        "--gear-ratio 20 -o log.csv");
    c.add_option("log", files_, "file to read; several files are one recording whose columns are spread over them")
        ->required()
        ->type_name("FILE");
    c.add_option("--robot", robot_file_, "robot file (URDF)")->required()->type_name("ROBOT");
    c.add_option("--map", options_.map_file, "column map (TOML)")->type_name("FILE");
    c.add_option("--map-out", map_out_,
                 "column map to write: the guess, with comments, to be mended and given back with --map")
        ->type_name("FILE");
    c.add_option("-o,--output", output_, "log to write (CSV)")->type_name("FILE");
    c.add_flag("--without-torque", without_torque_, "the recording is a motion only");
    add_constants(c);
    run.on(c, [this, &run] { execute(run); });
  }

 private:
  void add_constants(CLI::App& c) {
    MapDefaults& d = options_.defaults;
    const auto list = [&c](const char* flag, std::vector<double>& to, const char* help) {
      c.add_option(flag, to, help)
          ->delimiter(',')
          ->allow_extra_args(false)  // else it takes the file behind it for a number
          ->group("Constants, one for all drives or one for each: 20 or 20,20,20,5");
    };
    list("--gear-ratio", d.gear_ratio, "turns of the motor for one of the drive, where the recording is of the motor");
    list("--torque-constant", d.torque_constant, "of the motor [N m/A], for torques recorded as current");
    list("--rated-torque", d.rated_torque, "of the motor [N m], for torques recorded in % or per mille of it");
    list("--counts-per-turn", d.counts_per_turn, "of the encoder, for positions recorded in counts");
    list("--lead-m-turn", d.lead, "travel of a sliding drive for one turn of its motor [m]");
    const auto text = [&c](const char* flag, std::string& to, const char* help) {
      c.add_option(flag, to, help)->group("What the header does not say");
    };
    text("--position-unit", d.position_unit, "rad, deg, turns, m, mm, cnt");
    text("--velocity-unit", d.velocity_unit, "rad/s, deg/s, rpm, m/s, mm/s, cnt/s");
    text("--torque-unit", d.torque_unit, "Nm, mNm, N, A, mA, %, permille");
    text("--time-column", d.time_source, "name of the time column");
    text("--time-unit", d.time_unit, "s, ms, us, ns, min, filetime (100 ns)");
    text("--topic", d.topic, "of a ROS bag with several topics of joint states");
    c.add_option("--rate-hz", d.rate_hz, "of the recorder [Hz], where there is no time column")
        ->group("What the header does not say");
  }

  void execute(ToolRun& run) {
    if (output_.empty() && map_out_.empty()) {
      throw Error("neither -o nor --map-out is given, so nothing would be written", "",
                  "give -o log.csv, --map-out map.toml, or both", ExitCode::usage);
    }
    refuse_numbers_as_files();
    std::vector<std::string> inputs = files_;
    inputs.push_back(robot_file_);
    if (!options_.map_file.empty()) inputs.push_back(options_.map_file);
    run.check_files({output_, map_out_}, inputs);
    const RobotDescription robot = read_robot_file(robot_file_);
    options_.need_torque = !without_torque_;
    const LogImport import(files_, robot, options_);
    fmt::print("{}: {}\n", files_.front(), import.form());
    // A guess that is not complete is written, too: it is what the user mends.
    if (!map_out_.empty()) {
      write_file(map_out_, import.map_text());
      fmt::print("wrote {}: the column map\n", map_out_);
    }
    const auto result = output_.empty() ? log_or_open_question(import) : std::optional(log_or_mended_map(import));
    if (!result) return;
    print_taken(*result, import.recording(), robot);
    // The first note repeats the table for tools that have none.
    for (std::size_t k = 1; k < result->log.notes.size(); ++k) fmt::print("note: {}\n", result->log.notes[k]);
    if (!output_.empty()) {
      write_log(output_, result->log, robot);
      const Eigen::Index rows = result->log.samples();
      fmt::print("wrote {}: {} rows, {:.6g} s at {:.6g} Hz\n", output_, rows, result->log.t_s(rows - 1),
                 mean_rate(result->log));
    }
    add_figures(*result, run);
  }

  /// A map that was written just now is the one to be mended.
  [[nodiscard]] ImportedLog log_or_mended_map(const LogImport& import) const {
    try {
      return import.log();
    } catch (const Error& e) {
      if (map_out_.empty()) throw;
      throw Error(e.problem(), e.where(), mend_in_map(e.mend(), map_out_), e.code());
    }
  }

  /// A list with blanks gives its tail away, and that is read as files.
  void refuse_numbers_as_files() const {
    for (const std::string& file : files_) {
      char* end = nullptr;
      (void)std::strtod(file.c_str(), &end);
      if (*end != '\0' || std::filesystem::exists(file)) continue;
      throw Error(fmt::format("'{}' is no file but a number", file), "",
                  "separate the values of one flag by commas without blanks: --gear-ratio 20,20,20,5; delta-log import "
                  "--help shows "
                  "the flags",
                  ExitCode::usage);
    }
  }

  /// Where only a map was asked for, what is open is an answer and no failure.
  [[nodiscard]] std::optional<ImportedLog> log_or_open_question(const LogImport& import) const {
    try {
      return import.log();
    } catch (const Error& e) {
      fmt::print("still open: {}\n  {}\nmend {} and give it with --map\n", e.problem(), mend_in_map(e.mend(), map_out_),
                 map_out_);
      return std::nullopt;
    }
  }

  static std::string column_of(const TakenChannel& taken, const RobotDescription& robot) {
    const DriveColumns columns = drive_columns(robot, taken.map.drive - 1);
    switch (taken.map.quantity) {
      case Quantity::position: return columns.q;
      case Quantity::velocity: return columns.qd;
      case Quantity::acceleration: return columns.qdd;
      case Quantity::torque: return columns.tau;
    }
    return columns.q;
  }

  static void print_taken(const ImportedLog& result, const Recording& recording, const RobotDescription& robot) {
    std::size_t width = 4;
    for (const TakenChannel& taken : result.taken) width = std::max(width, taken.map.source.size());
    fmt::print("  {:<12} {:<{}}  {:<9} {:>12}  {:>9}  {}\n", "column", "from", width, "unit", "factor to SI",
               "rate [Hz]", "how");
    fmt::print("  {:<12} {:<{}}  {:<9}\n", "t_s", result.time_name, width, result.time_unit);
    for (const TakenChannel& taken : result.taken) {
      fmt::print("  {:<12} {:<{}}  {:<9} {:>12.6g}  {:>9.5g}  {}\n", column_of(taken, robot), taken.map.source, width,
                 taken.map.unit, taken.factor * taken.map.scale, taken.rate_hz, taken.how);
    }
    print_unused(result, recording);
  }

  static void print_unused(const ImportedLog& result, const Recording& recording) {
    constexpr std::size_t kMost = 40;
    std::vector<std::string> unused;
    for (const RecordedChannel& channel : recording.channels) {
      const bool taken = std::any_of(result.taken.begin(), result.taken.end(),
                                     [&](const TakenChannel& one) { return one.map.source == channel.name; });
      const bool time = std::any_of(recording.timelines.begin(), recording.timelines.end(),
                                    [&](const Timeline& one) { return one.name == channel.name; });
      if (!taken && !time) unused.push_back(channel.name);
    }
    const std::size_t more = unused.size() > kMost ? unused.size() - kMost : 0;
    unused.resize(unused.size() - more);
    if (!unused.empty())
      fmt::print("  not used: {}{}\n", fmt::join(unused, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
  }

  /// Rows after the first over the time they take [Hz]; the log's time begins at zero.
  static double mean_rate(const Log& log) {
    const Eigen::Index rows = log.samples();
    return log.t_s(rows - 1) > 0 ? static_cast<double>(rows - 1) / log.t_s(rows - 1) : 0.0;
  }

  static void add_figures(const ImportedLog& result, ToolRun& run) {
    run.summary.add("samples", static_cast<double>(result.log.samples()));
    run.summary.add("duration_s", result.log.t_s(result.log.samples() - 1), "s");
    run.summary.add("rate_hz", mean_rate(result.log), "Hz");
    for (const TakenChannel& taken : result.taken) {
      run.summary.add(fmt::format("source_{}_drive{}", word_of(taken.map.quantity), taken.map.drive), taken.map.source,
                      taken.map.unit);
    }
  }

  std::vector<std::string> files_;
  std::string robot_file_, output_, map_out_;
  bool without_torque_ = false;
  ImportOptions options_;
};

}  // namespace deltadyn::tools
