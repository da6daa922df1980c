#pragma once

/// \file
/// Which hypothesis is the best one in a state of the search.

#include <functional>
#include <optional>
#include <vector>

#include "search_effects.hpp"

namespace deltadyn::detail {

inline constexpr std::size_t kRefined = 8;  ///< hypotheses whose shapes are refined before they are compared

/// The hypotheses that are worth most and gain anything, the best first.
[[nodiscard]] std::vector<std::size_t> best_of(const EffectSearch& search, const EffectSearch::State& state,
                                               std::size_t count);

/// Is the second effect the first one with fewer parameters?
[[nodiscard]] bool holds(EffectId rich, EffectId simple);

/// Parameters by which an effect is clearly simpler than another one.
inline constexpr int kFewer = 2;

/// The simpler fit that gains nearly as much as the best one, else the best: its special case, or any effect with
/// clearly fewer parameters. The forms of the catalogue are not exact, and a richer one must not win by following what
/// is wrong with a simpler one.
/// \param gains  one a fit
[[nodiscard]] std::size_t simpler_one(const EffectSearch& search, const DiagnosisPolicy& policy,
                                      const std::vector<Fit>& fits, const std::vector<double>& gains, std::size_t best);

/// The hypothesis that is worth most once shapes are refined, among those that `counts` lets pass: the best one may be
/// noise that the null knows, and must not stand in the way of the next.
[[nodiscard]] std::optional<Fit> best_fit(const SearchContext& context, const EffectSearch::State& state,
                                          const std::function<bool(const Fit&)>& counts);

/// Friction that bends near rest only: not Coulomb's, and no effect.
[[nodiscard]] bool near_rest(const SearchContext& context, const Fit& fit);
/// What is corrected without a name: a skew or a lag of about a sample, and Coulomb's law that is smoothed near rest.
[[nodiscard]] bool hygienic(const SearchContext& context, const Fit& fit);

}  // namespace deltadyn::detail
