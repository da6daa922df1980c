#pragma once

/// \file
/// The model with the named effects: its parameters, bristles and ripples fitted anew, and the proof of it. Names that
/// it does not bear out are withdrawn.

#include <vector>

#include "diagnosis_steps.hpp"

namespace deltadyn::detail {

struct ImproveInput : DiagnosisInput {
  const VectorXd& p_fit;            ///< for the effects that need the model's torque
  const ProcessingOptions& extras;  ///< bristles and ripples that the search ended with
  const std::vector<int>& masked;   ///< drives whose rows near reversals it left out although they have bristles
  double cutoff_hz;                 ///< of the search
};

/// Bristles and ripples.
void take_extras(const ProcessingOptions& from, ProcessingOptions& to);

/// identify() of the logs without the effects' torque.
/// \param keep_extras  false: bristles and ripples are found anew
[[nodiscard]] Identification identify_beside(const ImproveInput& input, const std::vector<Log>& logs,
                                             const std::vector<Effect>& effects, bool keep_extras);

/// Fits the model with `out.named`, and takes back what the hold-out log does not bear out through the path of
/// delta-validate.
/// \param largest_share  of the noise variance, by a named effect: from it follows what is said if no name is left
void improve_and_prove(const ImproveInput& input, double largest_share, Diagnosis& out);

}  // namespace deltadyn::detail
