#pragma once

/// \file
/// A folder with good inputs, and ways to spoil them.

#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "acceptance/tool_run.hpp"

namespace deltadyn::acceptance {

/// A text file as lines; line k of the file is lines[k - 1].
using Lines = std::vector<std::string>;

inline Lines to_lines(const std::string& text) {
  Lines lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

inline std::string to_text(const Lines& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

inline std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, ',');) fields.push_back(field);
  return fields;
}

inline std::string join(const std::vector<std::string>& fields) {
  std::string line;
  for (std::size_t k = 0; k < fields.size(); ++k) line += (k > 0 ? "," : "") + fields[k];
  return line;
}

/// Replaces one field; `line` counts as in the file, `column` from 0.
inline void set_field(Lines& lines, std::size_t line, std::size_t column, const std::string& value) {
  auto fields = fields_of(lines.at(line - 1));
  fields.at(column) = value;
  lines[line - 1] = join(fields);
}

inline double field(const Lines& lines, std::size_t line, std::size_t column) {
  return std::stod(fields_of(lines.at(line - 1)).at(column));
}

/// Good inputs in a folder of their own: robot.urdf (delta4), log.csv (1.5 s of a real log, 1500 rows), prior.csv.
class Workshop {
 public:
  static constexpr std::size_t kRows = 1500;

  Workshop() {
    write("robot.urdf", read_text(installed("robots/mujoco_delta4.urdf")));
    write("prior.csv", read_text(installed("logs/mujoco_delta4/truth.csv")));
    write("log.csv", good_log());
  }

  [[nodiscard]] std::string path(const std::string& name) const { return folder_.path(name); }
  [[nodiscard]] std::string folder() const { return folder_.path(""); }
  std::string write(const std::string& name, const std::string& text) const { return folder_.write(name, text); }
  std::string write(const std::string& name, const Lines& lines) const { return folder_.write(name, to_text(lines)); }

  /// Header and kRows rows. Columns: t_s, q1_rad .. q4_rad, tau1_Nm .. tau4_Nm.
  static const Lines& good_log() {
    static const Lines log = [] {
      Lines lines = to_lines(read_text(installed("logs/mujoco_delta4/identification_fast.csv")));
      if (lines.size() <= kRows) throw std::runtime_error("the installed log is missing");
      lines.resize(kRows + 1);
      return lines;
    }();
    return log;
  }
  static Lines robot() { return to_lines(read_text(installed("robots/mujoco_delta4.urdf"))); }
  static Lines prior() { return to_lines(read_text(installed("logs/mujoco_delta4/truth.csv"))); }

  /// log.csv under another name, spoilt by `change`.
  std::string log(const std::string& name, const std::function<void(Lines&)>& change) const {
    Lines lines = good_log();
    change(lines);
    return write(name, lines);
  }
  std::string prior(const std::string& name, const std::function<void(Lines&)>& change) const {
    Lines lines = prior();
    change(lines);
    return write(name, lines);
  }
  /// The value of one parameter replaced.
  std::string prior_with(const std::string& name, const std::string& parameter, const std::string& value) const {
    return prior(name, [&](Lines& lines) {
      bool found = false;
      for (std::size_t k = 2; k <= lines.size(); ++k) {
        if (fields_of(lines[k - 1])[0] != parameter) continue;
        set_field(lines, k, 1, value);
        found = true;
      }
      if (!found) throw std::runtime_error("no parameter " + parameter);
    });
  }

  /// delta-identify on this folder. Missing arguments stand for the good files. A fixed cut-off keeps it fast.
  [[nodiscard]] Words identify(const std::string& log = "", const std::string& robot = "",
                               const std::string& prior = "") const {
    return {"delta-identify",
            robot.empty() ? path("robot.urdf") : robot,
            log.empty() ? path("log.csv") : log,
            "--prior",
            prior.empty() ? path("prior.csv") : prior,
            "-o",
            path("out.csv"),
            "--base",
            path("base.csv"),
            "--summary",
            path("summary.csv"),
            "--cutoff-hz",
            "50"};
  }
  [[nodiscard]] Words validate(const std::string& log = "", const std::string& robot = "",
                               const std::string& params = "") const {
    return {"delta-validate",
            robot.empty() ? path("robot.urdf") : robot,
            log.empty() ? path("log.csv") : log,
            "--params",
            params.empty() ? path("prior.csv") : params,
            "-o",
            path("out.csv"),
            "--summary",
            path("summary.csv"),
            "--cutoff-hz",
            "50"};
  }
  [[nodiscard]] Words info(const std::string& robot) const {
    return {"delta-model", "info", robot, "--summary", path("summary.csv")};
  }

 private:
  testing_support::TemporaryFolder folder_;
};

}  // namespace deltadyn::acceptance
