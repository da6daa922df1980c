#pragma once

/// \file
/// Steps 3 to 8 of the procedure: noise, null, and the effects that explain what the model leaves, each with its set.

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "../null/omnibus.hpp"
#include "effect_search.hpp"

namespace deltadyn::detail {

/// What the search is given.
struct SearchContext {
  const Robot& robot;
  const EffectModel& model;
  const BaseParameters& base;
  const std::vector<LogRows>& logs;
  const GenericBasis& basis;
  const EffectSearch& search;
  const DiagnosisOptions& options;
  const ProcessingOptions& processing;
  const VectorXd& p;
  PerLogAndDrive<double> position_noise = {};
  std::vector<Effect> denied = {};   ///< names that the hold-out log has spoken against: allowed for, not named
  const LogRows* holdout = nullptr;  ///< evaluated in `basis` behind the logs

  [[nodiscard]] const DiagnosisPolicy& policy() const { return options.policy; }
  [[nodiscard]] bool is_denied(const Effect& effect) const {
    const auto same = [&](const Effect& one) { return one.id == effect.id && one.joint == effect.joint; };
    return std::ranges::any_of(denied, same);
  }
};

struct SearchResult {
  PerLogAndDrive<NoiseModel> noise;   ///< beside everything found
  PerLogAndDrive<double> floor;       ///< rms that no model can beat
  EffectSearch::State before, after;  ///< beside the base model, and beside the accepted effects
  std::shared_ptr<const EncoderPilots> pilots;
  NullStudy null;
  Omnibus omnibus_before, omnibus_after;
  VectorXd structure_before, structure_after;  ///< gains of the generic basis, one a drive
  std::vector<Fit> fits;                       ///< the accepted effects
};

/// \param earlier  a search in the same logs with nearly the same parameters, whose noise, encoder pilots and null are
///                 taken as they are
[[nodiscard]] SearchResult search_effects(const SearchContext& context, const SearchResult* earlier = nullptr);

/// A fit as a candidate: names, gain and its chance on clean logs.
[[nodiscard]] EffectCandidate candidate_of(const SearchContext& context, const SearchResult& found, const Fit& fit);

/// Step 7: everything that the data cannot tell from `best` beside the other effects.
/// \param state  beside the others
/// \param place  of `best` in `found`
[[nodiscard]] std::vector<EffectCandidate> confusable_set(const SearchContext& context, const SearchResult& found,
                                                          const EffectSearch::State& state, const Fit& best,
                                                          std::size_t place);

/// Standard deviations of a fit's amplitudes and of its free shapes, fitted together: the larger of what the noise
/// model and what the residual's own blocks say, and beside it a share of the amplitude for the form of the column.
void set_uncertainty(const SearchContext& context, const EffectSearch::State& state, Fit& fit);

/// White rows of a segment in blocks of a quarter of a second, longer than what counts as memory of the noise: first
/// row and number.
[[nodiscard]] std::vector<std::pair<Index, Index>> row_blocks(const SearchContext& context,
                                                              const WhiteSegment& segment);

/// Rows a drive has on average: what the size of a gain is compared with.
[[nodiscard]] double rows_per_drive(const SearchContext& context, const WhiteProblem& problem);

}  // namespace deltadyn::detail
