#pragma once

/// \file
/// From logs to the rows that the diagnosis searches in: one cut-off for all, friction at rest left out, rows near
/// reversals used where the known bristles tell what friction does there.

#include <vector>

#include "deltadyn/diagnosis/policy.hpp"
#include "deltadyn/signal/log.hpp"

#include "log_rows.hpp"

namespace deltadyn::detail {

/// By which rows are made.
struct RowRules {
  const Robot& robot;
  const BaseParameters& base;
  const ProcessingOptions& wanted;  ///< what the user wants, and the bristles and ripples of the model
  const DiagnosisPolicy& policy;
};

struct DiagnosisRows {
  ProcessingOptions processing;     ///< of `logs` and `held`
  std::vector<LogRows> logs, held;  ///< signals left empty; `held` has at most one
};

/// Cut-offs for the search.
struct SearchCutoff {
  /// The one that delta-identify would choose for these logs, but no more than the search can use
  double chosen_hz = 0;
  double widest_hz = 0;  ///< where reversals would take too many rows at that one: a narrow low pass widens them
  /// Where they would still take nearly all: beyond the encoders' noise, which the search allows for
  double sharp_hz = 0;
};
[[nodiscard]] SearchCutoff search_cutoff(const RowRules& rules, const std::vector<Log>& logs, int threads);

/// \param cutoff_hz  that motion and torque share
/// \param holdout    may be null
/// \param masked     drives with bristles whose rows near reversals are left out all the same
/// Throws deltadyn::Error as prepare_log() does.
[[nodiscard]] DiagnosisRows prepare_rows(const RowRules& rules, const std::vector<Log>& logs, const Log* holdout,
                                         double cutoff_hz, const std::vector<int>& masked);

/// Drives with bristles whose rows near reversals do not follow the model as well as noise allows.
/// \param p  around which the parameters are fitted
[[nodiscard]] std::vector<int> drives_without_hold(const RowRules& rules, const EffectModel& model,
                                                   const std::vector<Log>& logs, double cutoff_hz, const VectorXd& p);

/// Rows of the drive of which least is known in all logs, less the directions that reversals take.
struct KnownRows {
  double count = 0;
  double share = 0;  ///< of all its rows
};
[[nodiscard]] KnownRows fewest_rows(const std::vector<LogRows>& logs);

}  // namespace deltadyn::detail
