#pragma once

/// \file
/// The checks of logs inside the tools: run, printed first, written to the summary.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <string>
#include <utility>
#include <vector>

#include "deltadyn/identification/log_gate.hpp"
#include "deltadyn/io/output_file.hpp"
#include "deltadyn/io/summary.hpp"
#include "deltadyn/report/log_report.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn::tools {

/// All findings: those of the reader in the order of the logs, then those of the gate.
inline std::vector<LogFinding> all_findings(const GateResult& gate) {
  std::vector<LogFinding> all;
  for (const Log& log : gate.logs) all.insert(all.end(), log.findings.begin(), log.findings.end());
  all.insert(all.end(), gate.findings.begin(), gate.findings.end());
  return all;
}

inline const char* level_word(FindingLevel level) {
  switch (level) {
    case FindingLevel::fine: return "fine";
    case FindingLevel::mended: return "mended";
    case FindingLevel::warning: return "warning";
    case FindingLevel::fault: return "fault";
  }
  return "";
}

/// Those that the terminal tells: of the reader's the ones that have words of their own in its notes (another drive's
/// finding may share them), each sentence once, and all of the gate's. What is in order stands in the table of the
/// channels.
inline std::vector<LogFinding> findings_to_tell(const GateResult& gate) {
  std::vector<LogFinding> out;
  for (const Log& log : gate.logs) {
    for (const LogFinding& f : log.findings) {
      const bool noted = std::find(log.notes.begin(), log.notes.end(), f.text) != log.notes.end();
      const bool told = std::any_of(out.begin(), out.end(), [&](const LogFinding& one) { return one.text == f.text; });
      if (noted && !told) out.push_back(f);
    }
  }
  out.insert(out.end(), gate.findings.begin(), gate.findings.end());
  return out;
}

/// The log that a finding is about, unless its text says it.
inline std::string where_of(const LogFinding& f) {
  return f.file.empty() || f.text.rfind(f.file, 0) == 0 ? "" : f.file + ": ";
}

/// Findings as lines, the worst first; what is in order only if asked.
inline void print_findings(const std::vector<LogFinding>& findings, bool with_fine) {
  bool uncertain = false;
  for (const FindingLevel level :
       {FindingLevel::fault, FindingLevel::warning, FindingLevel::mended, FindingLevel::fine}) {
    if (level == FindingLevel::fine && !with_fine) continue;
    for (const LogFinding& f : findings) {
      if (f.level != level) continue;
      const bool bad = level == FindingLevel::fault || level == FindingLevel::warning;
      std::FILE* to = bad ? stderr : stdout;
      const std::string word = level == FindingLevel::fine ? "" : std::string(level_word(level)) + ": ";
      fmt::print(to, "check: {}{}{}\n", word, where_of(f), f.text);
      if (bad && !f.mend.empty()) fmt::print(to, "  mend: {}\n", f.mend);
      uncertain |= f.text.find("+-") != std::string::npos;
    }
  }
  if (uncertain) fmt::print("  (a +- is one standard deviation)\n");
}

/// Keys check_KEY, check_KEY_driveK with their standard deviations, and check_verdict. Of several findings with one key
/// the worst counts, and among equals the first.
inline void summarise_findings(const std::vector<LogFinding>& findings, Summary& out) {
  FindingLevel worst = FindingLevel::fine;
  std::vector<std::pair<std::string, FindingLevel>> written;
  for (const LogFinding& f : findings) {
    worst = std::max(worst, f.level);
    const std::string key = "check_" + f.key + (f.drive >= 0 ? fmt::format("_drive{}", f.drive + 1) : "");
    const auto before = std::find_if(written.begin(), written.end(), [&](const auto& w) { return w.first == key; });
    if (before != written.end() && before->second >= f.level) continue;
    if (before != written.end()) before->second = f.level;
    if (before == written.end()) written.emplace_back(key, f.level);
    if (std::isfinite(f.value)) {
      out.add(key, f.value, f.unit);
      if (std::isfinite(f.std)) out.add(key + "_std", f.std, f.unit);
    } else {
      out.add(key, level_word(f.level));
    }
  }
  out.add("check_verdict", level_word(worst));
}

/// The flag and the work.
class LogGate {
 public:
  void add_to(CLI::App& app) {
    flag_ = app.add_flag("--keep-delay", keep_delay_,
                         "leave a delay between torque and position in the logs where one is found");
  }

  /// Leaves delays in place whatever the flag says: the tool weighs them itself. After add_to().
  void leave_delays() {
    keep_delays();
    flag_->description("always on: a delay between torque and position is one of the effects that are weighed");
  }

  /// Leaves delays in place for this run: the model at hand explains them.
  void keep_delays() { keep_delay_ = true; }

  /// Offsets of the torque are for the effects at hand to explain.
  void leave_offsets() { leave_offsets_ = true; }

  /// Checks and mends. Prints what was found, and adds it to the summary.
  /// \param with_fine  print what is in order, too
  GateResult run(const Robot& robot, std::vector<Log> logs, const Eigen::VectorXd& prior,
                 const Eigen::VectorXd& prior_std, bool prior_given, bool given_derivatives, Summary& summary,
                 bool with_fine = false) const {
    GateOptions options;
    options.keep_delay = keep_delay_;
    options.given_derivatives = given_derivatives;
    options.prior_given = prior_given;
    options.offsets_known = leave_offsets_;
    GateResult result = examine_logs(robot, std::move(logs), prior, prior_std, options);
    print_findings(findings_to_tell(result), with_fine);
    summarise_findings(all_findings(result), summary);
    return result;
  }

  [[nodiscard]] bool keeps_delay() const { return keep_delay_; }

  /// Logs with such a fault hold nothing that could be made sense of: says so. The report, if one was asked for, is
  /// that of the check.
  static ExitCode refuse(const Robot& robot, const GateResult& gate, const ReportContext& context,
                         const std::string& report_file, const char* tool) {
    if (!report_file.empty()) write_file(report_file, log_report(robot, gate.logs, context));
    for (const LogFinding& f : gate.findings) {
      if (f.level != FindingLevel::fault) continue;
      fmt::print(stderr, "{}: not to be trusted: {}. Nothing was computed from these logs.\n", tool, f.text);
      break;
    }
    return ExitCode::not_trusted;
  }

 private:
  CLI::Option* flag_ = nullptr;
  bool leave_offsets_ = false;
  bool keep_delay_ = false;
};

}  // namespace deltadyn::tools
