#pragma once

/// \file
/// Flags of the tools that read logs: how logs are filtered, and the files they come from.

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <string>
#include <vector>

#include "deltadyn/identification/log_processing.hpp"
#include "deltadyn/io/log_file.hpp"
#include "deltadyn/report/assessment.hpp"

#include "tool_support.hpp"

namespace deltadyn::tools {

/// Number or word of a flag like --cutoff-hz auto|VALUE. Throws Error(usage) that names the flag.
inline double number_of(const std::string& text, const std::string& flag, const std::string& words) {
  try {
    std::size_t used = 0;
    const double value = std::stod(text, &used);
    if (used == text.size() && std::isfinite(value)) return value;
  } catch (const std::exception&) {  // falls through to the message below
  }
  throw Error(fmt::format("{} {} is neither a number nor {}", flag, text, words), "", "give one of these",
              ExitCode::usage);
}

/// A word of a command line, in quotes where it holds blanks.
inline std::string quoted_word(const std::string& word) {
  return word.find(' ') == std::string::npos ? word : "'" + word + "'";
}

/// The flags and what they mean.
class ProcessingFlags {
 public:
  void add_to(CLI::App& app) {
    app.add_flag("--no-filter", no_filter_,
                 "take torque, q, qd and qdd of the log as they are (columns qd.., qdd.. required)");
    app.add_option("--cutoff-hz", cutoff_, "pass band of motion and torque [Hz], or auto: from the logs")
        ->capture_default_str();
    app.add_option("--period-s", period_, "period of a periodic log [s], auto, or none; equal periods are averaged")
        ->capture_default_str();
    app.add_option("--map", map_, "column map (TOML) for logs of other tools, as of delta-log import --map-out")
        ->type_name("FILE");
  }

  /// Options without the cut-off if that is automatic.
  [[nodiscard]] ProcessingOptions options() const {
    ProcessingOptions options;
    options.filter = !no_filter_;
    if (!automatic_cutoff()) options.cutoff_hz = number_of(cutoff_, "--cutoff-hz", "auto");
    if (period_ == "none") {
      options.periods = Periods::ignore;
    } else if (period_ != "auto") {
      options.periods = Periods::given;
      options.period_s = number_of(period_, "--period-s", "auto or none");
    }
    options.validate();
    return options;
  }
  [[nodiscard]] bool automatic_cutoff() const { return cutoff_ == "auto"; }
  /// What another tool needs to read the same logs: " --map map.toml", or nothing.
  [[nodiscard]] std::string reading_flags() const { return map_.empty() ? "" : " --map " + quoted_word(map_); }

  /// Reads the logs and prints what the reader had to say besides its findings, which LogGate tells. A log with gaps
  /// comes in parts (Log::part).
  [[nodiscard]] std::vector<Log> read_logs(const std::vector<std::string>& paths, const RobotDescription& robot) const {
    LogReadOptions options;
    options.need_derivatives = no_filter_;
    options.checks.motion = !no_filter_;
    options.checks.refuse_positions = false;  // the gate behind the reader says what they are
    options.map = map_;
    std::vector<Log> logs;
    for (const std::string& path : paths) {
      for (Log& part : read_log_parts(path, robot, options)) {
        if (!no_filter_ && !automatic_cutoff()) refuse_cutoff_beyond(0.4 / part.sample_time_s(), path);
        for (const std::string& note : part.notes) {
          const bool finding = std::any_of(part.findings.begin(), part.findings.end(),
                                           [&](const LogFinding& f) { return f.text == note; });
          if (!finding) fmt::print("note: {}\n", note);
        }
        logs.push_back(std::move(part));
      }
    }
    return logs;
  }

 private:
  void refuse_cutoff_beyond(double highest_hz, const std::string& path) const {
    if (number_of(cutoff_, "--cutoff-hz", "auto") > highest_hz) {
      throw Error(fmt::format("--cutoff-hz {} is too high for the sampling rate of this log", cutoff_), path,
                  fmt::format("give less than {:.4g} Hz, or auto", highest_hz), ExitCode::usage);
    }
  }

  bool no_filter_ = false;
  std::string cutoff_ = "auto";
  std::string period_ = "auto";
  std::string map_;
};

/// "N m" or "N", as the drive turns or slides.
inline const char* torque_unit(const RobotDescription& robot, int drive) {
  return robot.kind_of_drive(drive) == DriveKind::revolute ? "N*m" : "N";
}

/// Word of a verdict in summaries.
inline const char* verdict_word(Verdict verdict) {
  return verdict == Verdict::good ? "trusted" : (verdict == Verdict::caution ? "with-care" : "not-trusted");
}

/// The verdict in plain words, on the terminal as on top of the report, with what the check behind it means; warnings
/// on standard error.
inline void print_assessment(const Assessment& assessment) {
  const bool good = assessment.verdict == Verdict::good;
  std::FILE* to = good ? stdout : stderr;
  fmt::print(to, "{}{}\n", good ? "" : "warning: ", assessment.headline);
  for (const Check& check : assessment.checks) {
    if (good || check.verdict != assessment.verdict || assessment.headline.find(check.figure) == std::string::npos)
      continue;
    if (!check.meaning.empty()) fmt::print(to, "  {}\n", check.meaning);
    break;
  }
}

/// The command of delta-diagnose for these files. What a tool cannot know stays a word in capitals.
struct DiagnosisCommand {
  /// For validate: logs of the fit are not in the parameter file
  static constexpr const char* kTraining = "TRAINING_LOGS.csv";
  static constexpr const char* kHoldout = "ANOTHER_LOG.csv";  ///< for identify: all its logs took part in the fit
  std::string robot, parameters;
  std::vector<std::string> logs;  ///< of the fit; empty: not known
  std::string holdout;            ///< a log that took no part in it; empty: not known
  std::string flags;              ///< further ones, each with a blank before it

  [[nodiscard]] std::string text() const {
    std::string words;
    for (const std::string& log : logs) words += " " + quoted_word(log);
    return fmt::format("delta-diagnose {} --params {}{} --holdout {}{} -o diagnosis.csv", quoted_word(robot),
                       quoted_word(parameters), logs.empty() ? std::string(" ") + kTraining : words,
                       holdout.empty() ? kHoldout : quoted_word(holdout), flags);
  }
  /// What the words in capitals stand for; empty if there are none.
  [[nodiscard]] std::string legend() const {
    if (logs.empty()) return fmt::format("{}: the logs that the parameters were identified from", kTraining);
    return holdout.empty() ? fmt::format("{}: a log that took no part in the fit", kHoldout) : "";
  }
};

/// Structure that the model leaves has a name in most cases: says where it is and how to find the name. A timing error
/// that was mended counts, too: the diagnosis tells a lag of the drive from a delay of the recorder.
inline void point_to_diagnosis(const Assessment& assessment, const std::vector<LogFinding>& findings,
                               DiagnosisCommand command) {
  const bool mended_timing = std::any_of(findings.begin(), findings.end(), [](const LogFinding& f) {
    return f.level == FindingLevel::mended && (f.key.rfind("delay", 0) == 0 || f.key.rfind("lag", 0) == 0);
  });
  if (!assessment.structure && !mended_timing) return;
  if (assessment.structure) {
    fmt::print("{}\n", structure_in_words(*assessment.structure));
  } else {
    command.flags += " --keep-delay";
  }
  fmt::print("  to name what is {}: {}\n", assessment.structure ? "missing" : "behind the timing", command.text());
  if (const std::string legend = command.legend(); !legend.empty()) fmt::print("  ({})\n", legend);
}

/// The whole command line, for reports.
inline std::string command_line(int argc, char** argv) {
  std::string text;
  for (int i = 0; i < argc; ++i) {
    const std::string word = argv[i];
    const auto slash = i == 0 ? word.rfind('/') : std::string::npos;
    text += (i > 0 ? " " : "") + (slash == std::string::npos ? word : word.substr(slash + 1));
  }
  return text;
}

}  // namespace deltadyn::tools
