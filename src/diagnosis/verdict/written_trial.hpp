#pragma once

/// \file
/// The model with the named effects: its parameters, bristles and ripples fitted anew, and the proof of it. Names that
/// it does not bear out are withdrawn.

#include <vector>

#include "deltadyn/diagnosis/diagnose.hpp"

#include "judge.hpp"
#include "written_proof.hpp"

namespace deltadyn::detail {

/// What diagnose() is given.
struct DiagnosisInput {
  const Robot& robot;
  const std::vector<Log>& logs;
  const Log* holdout;
  const VectorXd& p;                 ///< of the model as given
  const VectorXd& p_std;             ///< of what the improved model's fit keeps to
  const std::vector<Effect>& known;  ///< effects of the model as given
  const DiagnosisOptions& options;
  const ValidatedLogs& training;
  const GivenModel& given;  ///< on the hold-out log, if there is one
};

struct TrialInput : DiagnosisInput {
  const VectorXd& p_fit;            ///< for the effects that need the model's torque
  const ProcessingOptions& extras;  ///< bristles and ripples that the search ended with
  const std::vector<int>& masked;   ///< drives whose rows near reversals it left out although they have bristles
  double cutoff_hz;                 ///< of the search
};

/// Bristles and ripples.
void take_extras(const ProcessingOptions& from, ProcessingOptions& to);

/// identify() of the logs without the effects' torque.
/// \param keep_extras  false: bristles and ripples are found anew
[[nodiscard]] Identification identify_beside(const TrialInput& input, const std::vector<Log>& logs,
                                             const std::vector<Effect>& effects, bool keep_extras);

/// Fits the model with `out.named`, and takes back what the hold-out log does not bear out through the path of
/// delta-validate.
/// \param facts  what decided so far; the proof is added, and the rules are tried again
void improve_and_prove(const TrialInput& input, VerdictFacts facts, Diagnosis& out);

}  // namespace deltadyn::detail
