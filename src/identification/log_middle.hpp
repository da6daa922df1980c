#pragma once

/// \file
/// The middle of a long log, for what needs only so much of it.

#include "deltadyn/signal/log.hpp"

namespace deltadyn {

/// At most `samples` samples from the middle of a log: positions, torque and the marks of what takes no part in a fit.
[[nodiscard]] inline Log middle_of(const Log& log, Eigen::Index samples) {
  if (log.samples() <= samples) return log;
  Log part;
  const Eigen::Index first = (log.samples() - samples) / 2;
  part.file = log.file;
  part.t_s = log.t_s.segment(first, samples);
  part.q = log.q.middleRows(first, samples);
  part.tau = log.tau.middleRows(first, samples);
  if (!log.filled.empty()) part.filled.assign(log.filled.begin() + first, log.filled.begin() + first + samples);
  if (log.torque_out.size() > 0) part.torque_out = log.torque_out.middleRows(first, samples);
  return part;
}

}  // namespace deltadyn
