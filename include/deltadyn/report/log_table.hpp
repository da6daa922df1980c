#pragma once

/// \file
/// What is measured of the channels of logs, as one compact table a log: for the terminal, and for the page of the
/// check.

#include <limits>
#include <string>
#include <vector>

#include "deltadyn/report/html_report.hpp"
#include "deltadyn/runtime/robot_description.hpp"
#include "deltadyn/signal/log.hpp"

namespace deltadyn {

/// One drive of one log, SI units. A step of 0 is not visible beside the noise; not a number: was not measured.
struct ChannelFigures {
  double travel = std::numeric_limits<double>::quiet_NaN(), step = travel, noise = travel;  ///< of the position
  double torque_step = travel, torque_noise = travel;
  double fresh_every = travel;  ///< rows between two updates of the position
  double moving = travel;       ///< share of the samples in which the drive is not at rest
};

/// One file; the parts of a log with gaps count as one.
struct LogFigures {
  std::string file;
  Eigen::Index rows = 0;
  double seconds = 0;  ///< of all parts, without the gaps between them
  double rate_hz = 0, jitter = 0, lost_rows = 0, held_rows = 0;
  std::vector<ChannelFigures> drives;
};

/// From the findings of the reader. Of the parts of a log the largest travel, step, noise and staleness count.
[[nodiscard]] std::vector<LogFigures> log_figures(const std::vector<Log>& logs);

/// "recorded at 1000 Hz, time stamps even, no row lost, none repeated".
[[nodiscard]] std::string timing_in_words(const LogFigures& log);

/// Lines for a terminal: the log with its timing, a head, one line a drive.
[[nodiscard]] std::vector<std::string> channel_lines(const RobotDescription& robot, const LogFigures& log);

/// The same on a page.
void add_channel_table(HtmlReport& report, const RobotDescription& robot, const std::vector<LogFigures>& logs);

}  // namespace deltadyn
