#pragma once

/// \file
/// One thing that a check has to say about a log, in words for people and as a figure for scripts.

#include <limits>
#include <string>

namespace deltadyn {

/// What a finding means for the work that follows.
enum class FindingLevel {
  fine,     ///< a measured property that is in order (rate, noise, ...); only for summaries and reports
  mended,   ///< certain and harmless: the log was mended, and this says how
  warning,  ///< ambiguous or of limited harm: the result stands, with this beside it
  fault     ///< certain and harmful: a result from this log is not to be trusted
};

/// A finding of a log check.
struct LogFinding {
  FindingLevel level = FindingLevel::fine;
  /// Summary key without the prefix `check_` and without drive: "delay", "stale", "torque_scale"
  std::string key = {};
  std::string file = {};                                    ///< log that it was found in; empty: all logs together
  int drive = -1;                                           ///< from 0; -1: no single drive
  double value = std::numeric_limits<double>::quiet_NaN();  ///< the figure behind it, in `unit`
  double std = std::numeric_limits<double>::quiet_NaN();    ///< its standard deviation, if it is an estimate
  std::string unit = {};                                    ///< of value, "" for a plain number
  std::string text = {};                                    ///< one sentence with the figures
  /// The next step that would succeed; empty if there is nothing to do
  std::string mend = {};
};

}  // namespace deltadyn
