#pragma once

/// \file
/// Can the result be trusted? The judgement behind the verdict of the reports, apart from the page it is printed on, so
/// that a tool can print it, too, and choose its exit code by it.

#include <string>
#include <vector>

#include "deltadyn/identification/identify.hpp"
#include "deltadyn/identification/mass_matrix_survey.hpp"
#include "deltadyn/identification/residual_structure.hpp"
#include "deltadyn/identification/structure_left.hpp"
#include "deltadyn/identification/torque_uncertainty.hpp"
#include "deltadyn/identification/validate.hpp"
#include "deltadyn/report/html_report.hpp"

namespace deltadyn {

/// One question put to the result.
struct Check {
  std::string subject;  ///< e.g. "Size of the residual"
  std::string figure;   ///< what was found, e.g. "1.2 % of the torque (drive 4)"
  Verdict verdict = Verdict::good;
  std::string meaning;  ///< what it means for the user, and what to do about it if it is not good; one or two sentences
};

struct Assessment {
  Verdict verdict = Verdict::good;  ///< the worst one of the checks
  std::string headline;             ///< one sentence
  std::string measured;             ///< "Measured by these logs: ...", true unless the verdict is bad
  std::vector<std::string> lines;   ///< what is not trustworthy, what to do next
  std::vector<Check> checks;
  std::optional<StructureLeft> structure;  ///< what the model leaves in the residual, for delta-diagnose to name

  /// The lines below the headline: what is measured, if the verdict lets it stand, then `lines`.
  [[nodiscard]] std::vector<std::string> told() const;
};

/// What is left in a residual, in one sentence without its full stop: for the terminal and the report alike.
[[nodiscard]] std::string structure_in_words(const StructureLeft& structure);

/// How a parameter shows in the torques of the drives.
enum class Visibility {
  alone,     ///< a motion can tell its value
  combined,  ///< only in sums with others: no motion of the drives can tell its value apart
  hidden,    ///< not at all
};

/// One value a parameter.
[[nodiscard]] std::vector<Visibility> parameter_visibility(const BaseParameters& base);

/// Where a value comes from, by its data share.
enum class Source { data, both, prior };
[[nodiscard]] Source source_of(double data_share);

/// What is left to the prior in one body or joint, and what would replace it.
struct PriorGap {
  ParameterId first;                    ///< of the parameters, all of one body or joint
  double first_share = 0;               ///< data share of that
  std::vector<std::string> parameters;  ///< "m (8 %)": name and data share
  bool by_motion = false;               ///< another motion of the drives would do
  bool negligible = false;              ///< a motion could show it, but it acts too little on the torques to matter
  std::string advice;                   ///< "weigh the tool"
};

/// All of them, in the order of the parameters; those that do not show in the torques are left out.
/// \param parameter_effect  as of parameter_effect(), one value a parameter
[[nodiscard]] std::vector<PriorGap> prior_gaps(const ConsistentFitSummary& fit, const BaseParameters& base,
                                               const Eigen::VectorXd& parameter_effect);

/// False if the estimate of a parameter lies so far from its prior that the prior cannot have decided it.
[[nodiscard]] bool held_by_prior(const ConsistentFitSummary& fit, Eigen::Index parameter);

/// What a reader may think of a value.
enum class DecidedBy {
  data,
  both,
  sums,    ///< the data know sums with others; the value by itself may be far off
  prior,   ///< the prior's value, hardly moved
  neither  ///< moved to keep its body consistent, with nothing that holds it
};
[[nodiscard]] DecidedBy decided_by(const ConsistentFitSummary& fit, Visibility visibility, Eigen::Index parameter);

/// The data decided it, and its standard deviation is small beside it.
[[nodiscard]] bool is_measured(const ConsistentFitSummary& fit, Visibility visibility, Eigen::Index parameter);

/// What the judgement on an identification rests on besides the fit.
struct IdentificationEvidence {
  std::optional<StructureLeft> structure;  ///< of the training logs
  TorqueUncertainty on_logs, in_workspace;
  Eigen::VectorXd parameter_effect;  ///< parameter_effect() of the fit
  /// Of each drive's record, rms in the rows of the training logs [N m | N]; may be empty
  std::vector<double> torque_noise;
};

[[nodiscard]] IdentificationEvidence gather_evidence(const Robot& robot, const Identification& identification,
                                                     const Validation& training);

[[nodiscard]] Assessment assess_identification(const Robot& robot, const Identification& identification,
                                               const MassMatrixSurvey& survey, const IdentificationEvidence& evidence);

[[nodiscard]] Assessment assess_validation(const Robot& robot, const Validation& validation);

}  // namespace deltadyn
