#pragma once

/// \file
/// The gate before the fit: are these logs what they seem to be? Delay between torque and position, signs, order, units
/// and zeros of the drives, the scale of the torque, given derivatives. One hypothesis a kind of fault, judged together
/// on a small part of the logs; what is certain and harmless is mended.

#include <Eigen/Core>
#include <vector>

#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/signal/log.hpp"

namespace deltadyn {

struct GateOptions {
  bool keep_delay = false;         ///< say a delay, but leave it in the log
  bool given_derivatives = false;  ///< the tool will take q, qd and qdd of the logs as they are (--no-filter)
  bool offsets_known = false;      ///< effects of the model, or of the search at hand, explain offsets of the torque
  bool prior_given = false;        ///< the prior is the user's, not one of simple shapes
};

struct GateResult {
  std::vector<Log> logs;             ///< as given, or mended
  std::vector<LogFinding> findings;  ///< of the gate alone; Log::findings holds those of the reader
  /// A finding of level fault.
  [[nodiscard]] bool fault() const;
  /// A fault that makes a fit senseless (signs, order, units), other than one that only scales its result, poses out of
  /// reach, which the fit refuses with their line, and torque without an explanation, which a diagnosis may find.
  [[nodiscard]] bool stop() const;
};

/// \param prior, prior_std  one value a parameter of the robot; empty: the scale of the torque is not looked at
/// Never throws for what a log holds.
[[nodiscard]] GateResult examine_logs(const Robot& robot, std::vector<Log> logs, const Eigen::VectorXd& prior,
                                      const Eigen::VectorXd& prior_std, const GateOptions& options = {});

}  // namespace deltadyn
