#include "deltadyn/report/log_report.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/report/format.hpp"
#include "deltadyn/report/log_table.hpp"

#include "drive_figures.hpp"
#include "drive_names.hpp"

namespace deltadyn {
namespace {

struct LevelWords {
  const char* word;
  Tone tone;
};

LevelWords words_of(FindingLevel level) {
  static constexpr LevelWords kWords[] = {
      {"fine", Tone::plain}, {"mended", Tone::good}, {"warning", Tone::caution}, {"fault", Tone::bad}};
  return kWords[static_cast<std::size_t>(level)];
}

std::string figure_of(const LogFinding& f) {
  if (!std::isfinite(f.value)) return "–";
  // Delays are milliseconds.
  const bool in_ms = f.unit == "s" && std::isfinite(f.std);
  const double factor = in_ms ? 1e3 : 1.0;
  const std::string unit = in_ms ? "ms" : f.unit;
  return std::isfinite(f.std) ? format_with_uncertainty(factor * f.value, factor * f.std, unit)
                              : format_number(f.value, unit, 4);
}

/// The findings that are more than a measured property in order; nothing if there are none.
void add_finding_table(HtmlReport& report, const std::vector<LogFinding>& findings, bool with_fine) {
  Table table(
      {text_column(""), text_column("finding"), "figure", "drive", text_column("log"), text_column("what to do")});
  for (const FindingLevel level :
       {FindingLevel::fault, FindingLevel::warning, FindingLevel::mended, FindingLevel::fine}) {
    if (level == FindingLevel::fine && !with_fine) continue;
    for (const LogFinding& f : findings) {
      if (f.level != level) continue;
      table.row({words_of(level).word, f.text, figure_of(f), f.drive < 0 ? "" : std::to_string(f.drive + 1),
                 f.file.empty() ? "" : short_name(f.file), f.mend},
                words_of(level).tone);
    }
  }
  if (!table.empty()) report.table(table, "What the check of the logs found; ± is one standard deviation.");
}

}  // namespace

Verdict verdict_of(const std::vector<LogFinding>& findings) {
  Verdict verdict = Verdict::good;
  for (const LogFinding& f : findings) {
    if (f.level == FindingLevel::fault) return Verdict::bad;
    if (f.level == FindingLevel::warning) verdict = Verdict::caution;
  }
  return verdict;
}

std::string check_verdict_in_words(const std::vector<LogFinding>& findings) {
  const auto count = [&](FindingLevel level) { return std::ranges::count(findings, level, &LogFinding::level); };
  const auto faults = count(FindingLevel::fault), warnings = count(FindingLevel::warning),
             mended = count(FindingLevel::mended);
  const std::string rest = (warnings == 0 ? "" : ", " + counted(warnings, "warning")) +
                           (mended == 0 ? "" : ", " + counted(mended, "finding") + " mended");
  if (faults > 0)
    return fmt::format("a model from these logs is not to be trusted: {}{}", counted(faults, "fault"), rest);
  if (warnings > 0) return "these logs can be used with care: no fault was found" + rest;
  return "no fault was found" + rest;
}

void add_log_check(HtmlReport& report, const std::vector<LogFinding>& findings) {
  if (std::ranges::all_of(findings, [](const LogFinding& f) { return f.level == FindingLevel::fine; })) return;
  report.heading("Check of the logs");
  add_finding_table(report, findings, false);
}

void weigh_findings(const std::vector<LogFinding>& findings, Assessment& assessment) {
  for (const LogFinding& f : findings) {
    if (f.level != FindingLevel::fault) continue;
    assessment.verdict = Verdict::bad;
    assessment.headline = "Do not use this result: the check of the logs found a fault (" + f.text + ").";
    return;
  }
  for (const LogFinding& f : findings) {
    // Derivatives in the file that nobody used are no matter to the result.
    if (f.level != FindingLevel::warning || f.key == "rate" || f.key == "acceleration") continue;
    if (assessment.verdict == Verdict::bad) return;
    if (assessment.verdict == Verdict::good)
      assessment.headline = "To be used with care: the check of the logs warns (" + f.text + ").";
    assessment.verdict = Verdict::caution;
    return;
  }
}

std::string log_report(const Robot& robot, const std::vector<Log>& logs, const ReportContext& context) {
  const RobotDescription& description = robot.description();
  HtmlReport report("Check of logs of " + description.name,
                    fmt::format("{}, {}", robot_in_words(description), counted(std::ssize(logs), "log")));
  const Verdict verdict = verdict_of(context.findings);
  std::vector<std::string> lines;
  for (const LogFinding& f : context.findings) {
    if (f.level == FindingLevel::fault || f.level == FindingLevel::warning) lines.push_back(f.text);
  }
  report.verdict(verdict,
                 verdict == Verdict::good      ? "Nothing was found that speaks against these logs."
                 : verdict == Verdict::caution ? "These logs can be used with care."
                                               : "A model from these logs is not to be trusted.",
                 lines);
  report.heading("Findings");
  // What is in order of single channels stands in a table of its own.
  std::vector<LogFinding> findings;
  std::copy_if(context.findings.begin(), context.findings.end(), std::back_inserter(findings),
               [](const LogFinding& f) { return f.level != FindingLevel::fine || f.file.empty(); });
  add_finding_table(report, findings, true);
  report.heading("Channels");
  add_channel_table(report, description, log_figures(logs));
  report.heading("Data");
  Facts facts = {{"Robot file", context.robot_file}};
  for (const Log& log : logs) {
    facts.emplace_back("Log", fmt::format("{}: {} samples, {} Hz", log.file, format_count(log.samples()),
                                          log.samples() > 1 ? format_number(1 / log.sample_time_s(), "", 4) : "–"));
  }
  report.facts(facts);
  report.footer(context.command_line);
  return report.str();
}

}  // namespace deltadyn
