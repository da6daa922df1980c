#pragma once

/// \file
/// The laws of the catalogue are not the machine's: what a named effect's form leaves must not be taken for a further
/// effect.

#include <optional>

#include "search_effects.hpp"

namespace deltadyn::detail {

/// Judges further effects beside those found so far, in one state of the search.
class FormErrors {
 public:
  /// \param state  beside what was found
  /// \param but    the effect of `found` that is in question
  FormErrors(const SearchContext& context, const SearchResult& found, const EffectSearch::State& state,
             std::optional<std::size_t> but = std::nullopt);

  /// Can the form of another effect have left what `fit` gains? Most is left at the same place and in what that effect
  /// depends on itself; what it does on other drives than `fit` does not count.
  [[nodiscard]] bool explain(const Fit& fit) const;

 private:
  [[nodiscard]] bool counts(std::size_t k) const { return !found_.fits[k].hygiene && k != but_; }
  /// What an effect of `found` gains: then, or alone, as one that came later may have gained little beside a mixture.
  [[nodiscard]] double gain_of(std::size_t k) const;
  /// Largest gain of an effect at a joint.
  [[nodiscard]] double best_at(int joint) const;
  /// An error of form looks like several effects and like none of them well: this one gains far more than any other
  /// class.
  [[nodiscard]] bool stands_out(const Fit& fit) const;

  const SearchContext& context_;
  const SearchResult& found_;
  const EffectSearch::State& state_;
  std::optional<std::size_t> but_;
  std::vector<VectorXd> squares_;  ///< of each effect found, what a re-fit leaves, by drive
};

}  // namespace deltadyn::detail
