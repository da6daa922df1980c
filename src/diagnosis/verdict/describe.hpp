#pragma once

/// \file
/// What the search has seen, for people: fits and structure of every drive, and the list of all effects considered.

#include "../search/search_effects.hpp"

namespace deltadyn::detail {

/// Motion, torque and rows of a log, with room for the residuals.
[[nodiscard]] DiagnosisTrace trace_of(const LogRows& log);

/// \param p,known  the model that the user gave
void describe_drives(const SearchContext& context, const SearchResult& found, const VectorXd& p,
                     const std::vector<Effect>& known, Diagnosis& out);

void list_considered(const SearchContext& context, const SearchResult& found, Diagnosis& out);

/// Names and sets may have changed since the effects were ruled on: the rulings say what holds at the end.
void settle_rulings(Diagnosis& out);

}  // namespace deltadyn::detail
