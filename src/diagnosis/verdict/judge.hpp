#pragma once

/// \file
/// From what the search has found to the facts that the rules look at, and from the rule that decides to the diagnosis.

#include "../search/search_effects.hpp"
#include "rules.hpp"

namespace deltadyn::detail {

/// Steps 9 and 10: names with their remarks, structure that is left, and the hold-out log in the rows of the search,
/// all into `out`.
/// \param known  effects that the model held before
[[nodiscard]] VerdictFacts facts_of(const SearchContext& context, const SearchResult& found,
                                    const std::vector<Effect>& known, Diagnosis& out);

/// The deciding rule, and what follows from it for the names. To be called again when facts have changed.
void decide(const VerdictFacts& facts, const DiagnosisPolicy& policy, Diagnosis& out);

/// Nothing is added to the model as it was given.
void withdraw_names(const std::vector<Effect>& known, Diagnosis& out);

/// Drives that the effects reach.
[[nodiscard]] std::vector<int> reached_drives(const std::vector<NamedEffect>& named);
/// Root mean square over drives.
/// \param rms  of each drive
[[nodiscard]] double rms_over(const std::vector<int>& drives, const VectorXd& rms);

/// "NAME at drive1 and OTHER at drive2"
[[nodiscard]] std::string listed(const std::vector<NamedEffect>& named);

/// Of two diagnoses of the same logs in bands of different width, is `one` to be kept: does it name what `other` does
/// not, or leave less of the hold-out log (without one: of the structure) beside its names?
[[nodiscard]] bool explains_more(const Diagnosis& one, const Diagnosis& other);

}  // namespace deltadyn::detail
