#pragma once

/// \file
/// Local search by sequential quadratic programming (NLopt's SLSQP).

#include <Eigen/Core>
#include <functional>

#include "design_problem.hpp"

namespace deltadyn::detail {

/// What a share of the time that a drive lacks away from reversals costs, in units of the share of its amplitude that a
/// motion over its limits must give up: dear enough that a motion with its share wins.
constexpr double kPriceOfReversals = 5;

struct SearchResult {
  Eigen::VectorXd best;  ///< by value, less what the violation of the limits will cost when the motion is made smaller
  int evaluations = 0;
};

/// Makes the value large inside the smooth limits. Deterministic unless `stop` ends it.
/// \param start  v
/// \param stop   asked before every evaluation
[[nodiscard]] SearchResult local_search(const DesignProblem& problem, const Eigen::VectorXd& start, int evaluations,
                                        const std::function<bool()>& stop);

}  // namespace deltadyn::detail
