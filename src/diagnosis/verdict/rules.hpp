#pragma once

/// \file
/// The verdict as one ordered table of rules: the first that holds decides. Each is a pure function of what was found.

#include <cstddef>
#include <vector>

#include "deltadyn/diagnosis/diagnose.hpp"

namespace deltadyn::detail {

/// What the proof of the model that would be written said.
enum class WrittenModelIs { not_tried, better, no_better, not_testable };

/// All that the rules look at.
struct VerdictFacts {
  std::size_t names = 0;          ///< effects that count, that a machine can have and the hold-out log asks for, too
  std::size_t open_courses = 0;   ///< of these, friction whose course beyond the logs' speeds is open
  bool sets = false;              ///< one of them has others that cannot be told from it
  double explained_share = 0;     ///< of all structure, by the names
  double structure_left = 0;      ///< beside the names, clear of noise, over the noise variance of the worst drive
  bool structure_counts = false;  ///< that is as large as the noise, or material and found again on the hold-out log
  double holdout_gap = 1;         ///< rms over floor on the hold-out log, of the worst drive that the names reach
  double holdout_left = 1;        ///< rms with the names over what training makes one expect, of the worst of these
  double gap_closed = 1;          ///< share of that gap that the names close; 1 without hold-out log
  bool overt = false;             ///< without the names a drive stands plainly above its floor
  int slow_drive = -1;            ///< that bears a slow torque which nothing explains; -1: none
  int missed_drive = -1;          ///< whose hold-out log is missed where training shows nothing; -1: none
  bool base_hidden = false;       ///< the motion does not show all base parameters
  WrittenModelIs written = WrittenModelIs::not_tried;
};

struct VerdictRule {
  VerdictReason reason;
  DiagnosisVerdict verdict;
  bool (*holds)(const VerdictFacts&, const DiagnosisPolicy&);
};

/// In the order in which they are tried; the last one always holds.
[[nodiscard]] const std::vector<VerdictRule>& verdict_rules();
[[nodiscard]] const VerdictRule& deciding_rule(const VerdictFacts& facts, const DiagnosisPolicy& policy);

/// Do the names close as much of the gap on the hold-out log as names must?
[[nodiscard]] bool hold_on_holdout(const VerdictFacts& facts, const DiagnosisPolicy& policy);

}  // namespace deltadyn::detail
