#pragma once

/// \file
/// The verdict as one ordered table of rules: the first that holds decides. Each is a pure function of what was found.

#include <vector>

#include "deltadyn/diagnosis/diagnose.hpp"

namespace deltadyn::detail {

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
