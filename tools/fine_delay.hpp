#pragma once

/// \file
/// A small delay found beside the friction of the model, taken out of the logs and said.

#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "deltadyn/identification/fine_delay.hpp"
#include "deltadyn/io/summary.hpp"
#include "deltadyn/signal/log_finding.hpp"

namespace deltadyn::tools {

/// The delay by itself and in the sum with what the check of the logs had removed, so that who reads only that key has
/// it, too.
inline void summarise_fine_delay(const FineDelay& found, Summary& summary) {
  double removed = 0;
  std::string verdict;
  for (const Summary::Row& row : summary.rows()) {
    if (row.key == "check_delay") removed = std::stod(row.value);
    if (row.key == "check_verdict") verdict = row.value;
  }
  summary.add("check_fine_delay", found.delay_s, "s");
  summary.add("check_fine_delay_std", found.std_s, "s");
  summary.add("check_delay", removed + found.delay_s, "s");
  summary.add("check_delay_std", found.std_s, "s");
  if (verdict == "fine") summary.add("check_verdict", "mended");
}

/// Prints that such a delay was removed, and adds it to the summary.
/// \returns the finding, for reports
inline LogFinding tell_fine_delay(const FineDelay& found, Summary& summary) {
  LogFinding finding;
  finding.level = FindingLevel::mended;
  finding.key = "fine_delay";
  finding.value = found.delay_s;
  finding.std = found.std_s;
  finding.unit = "s";
  finding.text = fmt::format("torque is {:.2f} +- {:.2g} ms {}, as it shows beside the friction of the model: removed",
                             1e3 * std::abs(found.delay_s), 1e3 * found.std_s, found.delay_s > 0 ? "late" : "early");
  fmt::print("check: mended: {}\n", finding.text);
  summarise_fine_delay(found, summary);
  return finding;
}

/// Takes the delay out of `logs` if it is certain, and tells it.
/// \returns the finding, for reports; nothing if the logs stay as they are
inline std::optional<LogFinding> mend_fine_delay(const Robot& robot, const BaseParameters& base,
                                                 const ProcessingOptions& processing, std::vector<Log>& logs,
                                                 Summary& summary) {
  const FineDelay found = find_fine_delay(robot, base, logs, processing);
  if (!found.certain) return std::nullopt;
  logs = without_delay(std::move(logs), found.delay_s);
  return tell_fine_delay(found, summary);
}

}  // namespace deltadyn::tools
