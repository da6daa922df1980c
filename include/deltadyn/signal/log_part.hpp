#pragma once

/// \file
/// Parts of a log, for what needs only so much of it.

#include "deltadyn/signal/log.hpp"

namespace deltadyn {

/// Samples [first, first + count) of a log: positions, torque and the marks of what takes no part in a fit.
[[nodiscard]] inline Log part_of(const Log& log, Eigen::Index first, Eigen::Index count) {
  Log part;
  part.file = log.file;
  part.t_s = log.t_s.segment(first, count);
  part.q = log.q.middleRows(first, count);
  part.tau = log.tau.middleRows(first, count);
  if (!log.filled.empty()) part.filled.assign(log.filled.begin() + first, log.filled.begin() + first + count);
  if (log.torque_out.size() > 0) part.torque_out = log.torque_out.middleRows(first, count);
  return part;
}

/// At most `samples` samples from the middle of a log.
[[nodiscard]] inline Log middle_of(const Log& log, Eigen::Index samples) {
  if (log.samples() <= samples) return log;
  return part_of(log, (log.samples() - samples) / 2, samples);
}

}  // namespace deltadyn
