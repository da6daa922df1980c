/// \file
/// Are there values to work with: one a drive and sample, enough of them, all numbers.

#include <cmath>
#include <fmt/format.h>

#include "checks.hpp"

namespace deltadyn::checks {

void check_counts(CheckRoom& room) {
  const Log& log = room.log;
  const Index n = log.samples();
  const Index drives = room.robot.drives();
  const auto fits = [&](const Eigen::MatrixXd& block, bool needed) {
    return (block.size() == 0 && !needed) || (block.rows() == n && block.cols() == drives);
  };
  if (n == 0) throw Error("the log has no samples", log.file, "check that the recording is complete");
  if (!fits(log.q, true) || !fits(log.qd, false) || !fits(log.qdd, false) || !fits(log.tau, false)) {
    throw Error(fmt::format("the log has not one value a drive and sample ({} samples, {} drives)", n, drives),
                log.file, "give the robot file that fits the log");
  }
  if (!log.line.empty() && static_cast<Index>(log.line.size()) != n) {
    throw Error("the log has not one line number a sample", log.file, "leave Log::line empty if it is not known");
  }
}

void refuse_missing_numbers(CheckRoom& room) {
  for (const Channel& channel : room.channels()) {
    for (Index i = 0; i < room.log.samples(); ++i) {
      if (!std::isfinite(channel.values()(i))) {
        throw Error("a number is missing or not finite", room.where(i, channel.name),
                    "remove the row or correct the value");
      }
    }
  }
}

void check_length(CheckRoom& room) {
  const Log& log = room.log;
  const Index n = log.samples();
  const double duration = n < 2 ? 0.0 : log.t_s(n - 1) - log.t_s(0);
  if (n < kFewestSamples || (std::isfinite(duration) && duration >= 0 && duration < kShortestDuration_s)) {
    throw UnusablePart(
        fmt::format("the log is too short: {} samples, {:.4g} s", n, std::isfinite(duration) ? duration : 0.0),
        log.file,
        fmt::format("record at least {} samples and {:.4g} s; to identify a robot, some seconds of varied motion",
                    kFewestSamples, kShortestDuration_s));
  }
}

}  // namespace deltadyn::checks
