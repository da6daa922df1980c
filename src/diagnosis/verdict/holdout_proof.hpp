#pragma once

/// \file
/// The proof on a log that took no part: its residuals without and with what was found.

#include <cstdint>
#include <vector>

#include "../search/search_effects.hpp"

namespace deltadyn::detail {

/// Rows of the hold-out log: residuals before and after, and the floor.
struct HoldoutProof {
  MatrixXd before, after;
  /// By drive: columns of the effects that the model held and of those found, as in SearchResult::after
  std::vector<MatrixXd> effects;
  VectorXd rms_before, rms_after, floor;
  bool has_load = false;  ///< what some training logs have, the hold-out log has, too
  VectorXd unsure;        ///< rms of the base model's torque that the noise of the training logs leaves open
};

/// \param known  effects that the model held before
[[nodiscard]] HoldoutProof prove(const SearchContext& context, const SearchResult& found, const LogRows& held,
                                 const std::vector<Effect>& known);

/// Gap shrink over some drives, each in units of its floor, and its bootstrap interval, into `out`.
void shrink_of(const HoldoutProof& proof, const LogRows& held, const std::vector<int>& drives, std::uint64_t seed,
               Diagnosis& out);

/// Would the hold-out log ask for this effect, too, beside all the others? Its amplitude there, over the one that was
/// found, is about 1 for a property of the robot and about 0 for chance. True where the hold-out log hardly shows the
/// effect.
[[nodiscard]] bool carries_over(const SearchContext& context, const SearchResult& found, const HoldoutProof& proof,
                                const Fit& fit);

}  // namespace deltadyn::detail
