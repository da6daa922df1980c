#pragma once

/// \file
/// What the checks of a log share: the log, the robot, the options, and how they report.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/robot_description.hpp"
#include "deltadyn/signal/log.hpp"
#include "deltadyn/signal/log_check.hpp"
#include "deltadyn/signal/time_grid.hpp"

#include "channel_quality.hpp"

namespace deltadyn::checks {

using Eigen::Index;

inline constexpr int kLongestFilledRows = 3;        ///< longest run of missing samples that is filled in, however slow
inline constexpr Index kFewestSamples = 50;         ///< shorter logs are refused
inline constexpr double kShortestDuration_s = 0.5;  ///< shorter logs are refused

/// One column of the log.
struct Channel {
  Eigen::MatrixXd* block;
  Index drive;
  std::string name;
  bool position;  ///< smooth (position or its derivatives), not a torque
  [[nodiscard]] auto values() const { return block->col(drive); }
};

/// A stretch of the log cannot be used, while the rest may be.
class UnusablePart : public Error {
 public:
  using Error::Error;
};

/// The log under the checks. A check reads and mends `log`, and tells what it found.
struct CheckRoom {
  Log& log;
  const RobotDescription& robot;
  const LogCheckOptions& options;
  double& largest_jitter;  ///< of the time stamps of all parts, share of the sample time

  std::vector<Index> recordings{};     ///< first rows of further recordings in the same file
  std::vector<int> stale_positions{};  ///< rows between two updates of each drive's position; 1: always fresh
  std::vector<int> stale_torques{};
  int thinning = 1;       ///< rows between two updates of the slowest stale channel, to the nearest number
  TimeGrid grid{};        ///< of the stamps of this part
  Index fresh_row = 0;    ///< first row in which the slowest stale channel was measured
  bool resample = false;  ///< the stamps are true and uneven: values have to be moved to the grid

  /// Longest run of missing rows that is filled in, for rows that are step_s apart.
  [[nodiscard]] Index longest_filled(double step_s) const;

  [[nodiscard]] std::vector<Channel> channels() const;
  /// "log.csv, line 12, column q1_rad".
  [[nodiscard]] std::string where(Index sample, const std::string& column = {}) const;
  /// Notes a finding: the log's findings and, if it is more than a measured figure, its notes say it.
  /// \param with_note  false: the words stand in another finding's note already
  void tell(LogFinding finding, bool with_note = true) const;
  /// A finding in one sentence that begins with its place.
  void tell(FindingLevel level, const std::string& key, Index sample, const std::string& column, int drive,
            double value, const std::string& unit, const std::string& sentence, const std::string& mend = {}) const;
  /// Marks a sample whose values were made up; Log::kBridged never takes back Log::kLeftOut.
  void mark_filled(Index sample, char mark) const;
  [[nodiscard]] bool turns(Index drive) const {
    return robot.kind_of_drive(static_cast<int>(drive)) == DriveKind::revolute;
  }
  [[nodiscard]] double travel(Index drive, Index begin, Index end) const;
  [[nodiscard]] bool moves(Index drive) const;
  /// Keeps the given samples, in this order.
  void keep(const std::vector<Index>& rows) const;
};

/// Rows of a log in the given order, with all that belongs to them.
[[nodiscard]] Log rows_of(const Log& log, const std::vector<Index>& rows);
/// The rows [first, last).
[[nodiscard]] Log rows_of(const Log& log, Index first, Index last);

/// Counts what is of one kind, so that it is said once with the number and the first place.
struct Tally {
  Index count = 0;
  Index first = -1;
  void add(Index sample, Index samples = 1) {
    if (count == 0) first = sample;
    count += samples;
  }
};

}  // namespace deltadyn::checks
