#pragma once

/// \file
/// Noise of every drive and log: the residual of the base model, the effects accepted so far, and as much of the
/// generic basis as pays for itself. A basis that is fitted whole follows slow noise and makes it look smaller than it
/// is.

#include <vector>

#include "generic_basis.hpp"
#include "white_problem.hpp"

namespace deltadyn {

struct NoiseEstimate {
  PerLogAndDrive<NoiseModel> noise;
  PerLogAndDrive<double> floor_rms;  ///< rms of that residual in the rows themselves: no model can do better [N m | N]
  /// Logarithm of the likelihood of noise and chosen basis, less half the Bayesian penalty of both (Schwarz 1978):
  /// compares models with different effects, each with its own noise.
  double log_likelihood = 0;
};

/// \param extra  columns of effects that the model holds, [log][drive] rows x e
/// \param start  noise to begin with; one pass then serves to compare models. Null: three passes from white noise
[[nodiscard]] NoiseEstimate estimate_noise(const std::vector<LogRows>& logs, const GenericBasis& basis,
                                           const PerLogAndDrive<MatrixXd>& extra,
                                           const PerLogAndDrive<NoiseModel>* start = nullptr);

}  // namespace deltadyn
