#pragma once

/// \file
/// The laws of the catalogue are not the machine's: what a named effect's form leaves must not be taken for a further effect.

#include <optional>

#include "diagnosis_steps.hpp"

namespace deltadyn::detail {

/// Judges further effects beside those found so far, in one state of the search.
class FormErrors {
 public:
  /// \param state  beside what was found
  /// \param but    the effect of `found` that is in question
  FormErrors(const SearchContext& context, const SearchResult& found, const EffectSearch::State& state,
             std::optional<std::size_t> but = std::nullopt)
      : context_(context), found_(found), state_(state), but_(but) {}

  /// Can the form of an earlier effect have left what `fit` gains? More is left at the same place and in the same class; what the earlier
  /// one does on other drives than `fit` does not count.
  [[nodiscard]] bool explain(const Fit& fit);

 private:
  [[nodiscard]] bool counts(std::size_t k) const { return !found_.hygiene[k] && k != but_; }
  /// Largest gain of an effect at a joint.
  [[nodiscard]] double best_at(int joint) const;
  /// An error of form looks like several effects and like none of them well: an effect takes nearly all structure that the generic
  /// basis still sees, or gains far more than any other class.
  [[nodiscard]] bool stands_out(const Fit& fit);
  [[nodiscard]] double structure_of(const Eigen::VectorXd& r) const;
  [[nodiscard]] const std::string& class_of(const Fit& fit) const;

  const SearchContext& context_;
  const SearchResult& found_;
  const EffectSearch::State& state_;
  std::optional<std::size_t> but_;
  std::optional<Omnibus> omnibus_;
  double structure_ = 0;  ///< of the state's own residual
};

}  // namespace deltadyn::detail
