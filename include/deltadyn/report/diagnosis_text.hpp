#pragma once

/// \file
/// A diagnosis in words: for the terminal and for the report.

#include <string>
#include <vector>

#include "deltadyn/diagnosis/diagnose.hpp"

namespace deltadyn {

struct DiagnosisText {
  std::string headline;            ///< one sentence
  std::vector<std::string> lines;  ///< what was found
  std::vector<std::string> next;   ///< what to do next
  std::vector<std::string> notes;
};
[[nodiscard]] DiagnosisText diagnosis_text(const Robot& robot, const Diagnosis& diagnosis);

/// Where a named effect acts: drives, and the rates that hold four fifths of it.
[[nodiscard]] std::string region_text(const Robot& robot, const NamedEffect& one);
/// Where the verdict was decided, without a name; empty where it has no place.
[[nodiscard]] std::string place_text(const Robot& robot, const Diagnosis& diagnosis);
/// What became of an effect in the search.
[[nodiscard]] std::string ruling_text(const ConsideredEffect& one);
/// Why one of a set is (not) told apart from the named effect.
[[nodiscard]] std::string set_text(const NamedEffect& named, const EffectCandidate& other);
/// Does the hold-out log show how much of its gap the names close? An interval wider than the gap itself says nothing.
[[nodiscard]] bool shows_gap(const Diagnosis& diagnosis);
/// How much of it they close; empty without names or hold-out log.
[[nodiscard]] std::string gap_text(const Diagnosis& diagnosis);
/// What speaks against adding an effect to the model; empty where nothing does.
[[nodiscard]] std::string objection_text(const EffectCandidate& one);

}  // namespace deltadyn
