#pragma once

#include <string>
#include <vector>

#include "deltadyn/signal/log_finding.hpp"

namespace deltadyn {

/// Where the figures of a report come from, so that they can be made again.
struct ReportContext {
  std::string robot_file;
  std::vector<std::string> log_files;
  /// Prior of an identification, model of a validation; empty: nominal values of simple shapes
  std::string parameter_file;
  std::string command_line;
  std::vector<LogFinding> findings = {};  ///< of the check of the logs; they stand first
};

}  // namespace deltadyn
