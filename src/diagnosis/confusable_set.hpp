#pragma once

/// \file
/// Step 7: what else a named effect could be.

#include <vector>

#include "diagnosis_steps.hpp"

namespace deltadyn::detail {

/// A fit as a candidate: names, gain and its chance on clean logs.
[[nodiscard]] EffectCandidate candidate_of(const SearchContext& context, const SearchResult& found, const Fit& fit);

/// Everything that the data cannot tell from `best` beside the other effects.
/// \param state  beside the others
/// \param place  of `best` in `found`
[[nodiscard]] std::vector<EffectCandidate> confusable_set(const SearchContext& context, const SearchResult& found,
                                                          const EffectSearch::State& state, const Fit& best,
                                                          std::size_t place);

}  // namespace deltadyn::detail
