#pragma once

/// \file
/// What a re-fit of the model leaves of an effect's torque.

#include "search_effects.hpp"

namespace deltadyn::detail {

/// In the rows of the logs [N m | N]: C a - [Y E] b for the b that takes most, E the columns of the effects that the
/// model holds.
struct Remainder {
  VectorXd beta;                    ///< b: base parameters, then amplitudes of the effects
  PerLogAndDrive<VectorXd> torque;  ///< [log][drive]; empty where there is none
};
/// \param columns  [log][drive] rows x k, empty where a drive is not reached
[[nodiscard]] Remainder remainder_of(const SearchContext& context, const WhiteProblem& problem,
                                     const PerLogAndDrive<MatrixXd>& columns, const VectorXd& amplitude);
/// Mean square of a remainder over the noise variance of each drive.
[[nodiscard]] VectorXd noise_shares(const SearchContext& context, const Remainder& remainder,
                                    const PerLogAndDrive<double>& floor);

/// In the problem's white rows. The fit may be one beside other effects.
[[nodiscard]] VectorXd remaining_torque(const WhiteProblem& problem, const Fit& fit);
/// Its squares, one value a drive: it also stands on drives that the effect itself does not reach.
[[nodiscard]] VectorXd remaining_squares_by_drive(const SearchContext& context, const WhiteProblem& problem,
                                                  const Fit& fit);

}  // namespace deltadyn::detail
