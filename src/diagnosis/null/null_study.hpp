#pragma once

/// \file
/// What the scores are when nothing is missing: the whole pipeline on simulated clean logs. Encoder noise enters as in
/// encoder_pilots.hpp, torque noise as the fitted autoregression.

#include <functional>
#include <vector>

#include "encoder_pilots.hpp"
#include "null_distribution.hpp"
#include "omnibus.hpp"

namespace deltadyn {

struct NullStudy {
  NullFamily hypotheses;     ///< of the gains, one a hypothesis
  NullFamily omnibus;        ///< of the generic basis' gains, one a drive
  double encoder_share = 0;  ///< of the white residual's variance that encoder noise makes
};

/// \param bias      EncoderPilots::bias of the same problem
/// \param progress  called with the share done
[[nodiscard]] NullStudy run_null_study(const EncoderPilots& pilots, const WhiteProblem& problem,
                                       const std::vector<Hypothesis>& hypotheses,
                                       const std::vector<Signature>& signatures, const std::vector<VectorXd>& bias,
                                       const Omnibus& omnibus, const DiagnosisOptions& options,
                                       const std::function<void(double)>& progress);

}  // namespace deltadyn
