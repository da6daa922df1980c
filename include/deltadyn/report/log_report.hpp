#pragma once

/// \file
/// What the check of logs found, as a page.

#include <string>
#include <vector>

#include "deltadyn/report/assessment.hpp"
#include "deltadyn/report/html_report.hpp"
#include "deltadyn/report/report_context.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/signal/log.hpp"

namespace deltadyn {

/// The page of `delta-log check`. Findings are those of the context.
[[nodiscard]] std::string log_report(const Robot& robot, const std::vector<Log>& logs, const ReportContext& context);

/// The section that stands first in a report: heading and table; nothing if all findings are fine.
void add_log_check(HtmlReport& report, const std::vector<LogFinding>& findings);

/// A fault in the logs outweighs whatever the fit looks like, a warning that bears on the result makes it one to use
/// with care.
void weigh_findings(const std::vector<LogFinding>& findings, Assessment& assessment);

/// The worst level among the findings.
[[nodiscard]] Verdict verdict_of(const std::vector<LogFinding>& findings);

/// The same in words, with how many faults, warnings and mends there are: "to be used with care: no fault, 2 warnings".
[[nodiscard]] std::string check_verdict_in_words(const std::vector<LogFinding>& findings);

}  // namespace deltadyn
