#pragma once

/// \file
/// The torque of a hypothesis in white rows, and how much of the residual it explains.

#include <functional>
#include <vector>

#include "../evidence/white_problem.hpp"
#include "hypothesis.hpp"

namespace deltadyn {

/// The whitened signatures of one hypothesis, all shapes.
struct Signature {
  WhiteColumns white;
  std::vector<MatrixXd> gram;  ///< of each shape, projected
  /// Of each shape: share of gram that is not encoder noise in the columns (1: none is known)
  std::vector<double> clean;
  std::vector<double> kept;  ///< of each shape: share of its (smallest direction's) square that a re-fit cannot absorb
};

[[nodiscard]] Signature make_signature(const WhiteProblem& problem, const Hypothesis& hypothesis,
                                       const PerLogAndDrive<MatrixXd>& rows);

struct Score {
  double gain = 0;
  std::size_t shape = 0;
  VectorXd amplitude;
};

/// Supremum of the gain over the shapes. Shapes that a re-fit absorbs count as nothing.
/// \param inner  C_perp^T r of all columns, WhiteProblem::inner
/// \param among  shapes that may win; empty: all
[[nodiscard]] Score best_score(const Hypothesis& hypothesis, const Signature& signature, const VectorXd& inner,
                               const std::function<bool(const VectorXd&)>& among = {});

}  // namespace deltadyn
