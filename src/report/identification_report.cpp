#include "deltadyn/report/identification_report.hpp"

#include <fmt/format.h>

#include "deltadyn/report/assessment.hpp"
#include "deltadyn/report/format.hpp"
#include "deltadyn/report/log_report.hpp"
#include "deltadyn/runtime/error.hpp"

#include "assessment_limits.hpp"
#include "assessment_parts.hpp"
#include "drive_figures.hpp"
#include "drive_names.hpp"
#include "identification_sections.hpp"

namespace deltadyn {
namespace {

std::vector<KeyFigure> key_figures(const Robot& robot, const Identification& identification,
                                   const MassMatrixSurvey& survey) {
  std::vector<KeyFigure> figures;
  for (std::size_t j = 0; j < identification.drives.size(); ++j) {
    const DriveReport& drive = identification.drives[j];
    const double relative = drive.rms_torque > 0 ? drive.rms / drive.rms_torque : 0.0;
    figures.push_back(residual_figure(robot, static_cast<int>(j), drive.rms, relative));
  }
  int fitted = 0, from_prior = 0;
  for (std::size_t i = 0; i < identification.fit.parameters.size(); ++i) {
    if (!identification.fit.fitted[i]) continue;
    ++fitted;
    from_prior += source_of(identification.fit.data_share(static_cast<Eigen::Index>(i))) == Source::prior ? 1 : 0;
  }
  figures.push_back({"base parameters", fmt::format("{} of {}", identification.base.count(), robot.parameters()),
                     fmt::format("condition {}", format_number(identification.base_estimate.condition_number, 3)),
                     identification.base_estimate.condition_number > kHighCondition ? Tone::caution : Tone::plain});
  figures.push_back(
      {"left to the prior", fmt::format("{} of {}", from_prior, fitted), "fitted parameters", Tone::plain});
  const bool axis = robot.description().parts.empty();
  figures.push_back({axis ? "moving inertia" : "min. eigenvalue of M", format_number(survey.min_eigenvalue, 3),
                     inertia_unit_of(robot) + (axis ? "" : fmt::format(", {} poses", format_count(survey.states))),
                     survey.positive_definite() ? Tone::good : Tone::bad});
  figures.push_back({"time to identify", format_duration(identification.total_time_s),
                     fmt::format("{} samples", format_count(identification.samples)), Tone::plain});
  return figures;
}

void add_settings(HtmlReport& report, const Robot& robot, const Identification& identification,
                  const Validation& training, const ReportContext& context) {
  Facts facts = source_facts(
      context, "Prior", context.parameter_file.empty() ? "nominal values of simple shapes" : context.parameter_file,
      training);
  const ConsistentFitSummary& fit = identification.fit;
  facts.emplace_back("Free variables of the fit",
                     fmt::format("{} of {} parameters", fit.variables, robot.parameters()));
  facts.emplace_back("Weight of the prior λ", fmt::format("{}, {}", format_number(fit.lambda, 3),
                                                          fit.lambda_from_data ? "chosen from the data" : "as given"));
  facts.emplace_back("Solver", fmt::format("{} interior-point and {} Ceres steps, {}", fit.interior_point_iterations,
                                           fit.iterations, format_duration(fit.solve_time_s)));
  if (fit.certificate.available) {
    facts.emplace_back(
        "Certificate",
        fmt::format("duality gap {} in χ² ({}), smallest dual eigenvalue {} ({})",
                    format_number(fit.certificate.gap, 2), fit.certificate.passed ? "passed" : "not passed",
                    format_number(fit.certificate.min_dual_eigenvalue, 2), fit.certificate.min_dual_name));
  }
  facts.emplace_back("Time",
                     fmt::format("{} in all, {} of it to fold the logs", format_duration(identification.total_time_s),
                                 format_duration(identification.fold_time_s)));
  report.facts(facts);
  std::vector<std::string> notes = identification.notes;
  notes.insert(notes.end(), fit.notes.begin(), fit.notes.end());
  if (!notes.empty()) report.subheading("Notes").list(notes);
}

}  // namespace

std::string identification_report(const Robot& robot, const Identification& identification, const Validation& training,
                                  const MassMatrixSurvey& survey, const ReportContext& context) {
  const auto drives = static_cast<std::size_t>(robot.drives());
  if (identification.drives.size() != drives || training.drives.size() != drives ||
      identification.fit.p.size() != robot.parameters() || survey.z_min.size() != robot.drives()) {
    throw Error("identification, prediction and survey are not those of this robot", robot.description().name,
                "make them with the same robot", ExitCode::usage);
  }
  const IdentificationEvidence evidence = gather_evidence(robot, identification, training);
  Assessment assessment = assess_identification(robot, identification, survey, evidence);
  weigh_findings(context.findings, assessment);
  const RobotDescription& description = robot.description();
  HtmlReport report("Identification of " + description.name,
                    fmt::format("{}, {}", robot_in_words(description), counted(std::ssize(training.logs), "log")));
  report.verdict(assessment.verdict, assessment.headline, assessment.told());
  add_log_check(report, context.findings);
  report.key_figures(key_figures(robot, identification, survey));

  report.heading("Checks");
  add_check_table(report, assessment);
  report.heading("Measured and model");
  add_fit_table(report, robot, identification);
  add_torque_figures(report, robot, training);
  report.heading("What to measure next");
  add_gap_table(report, prior_gaps(identification.fit, identification.base, evidence.parameter_effect));
  report.heading("Parameters");
  if (assessment.verdict == Verdict::bad) report.paragraph("None of these values is to be trusted: see the verdict.");
  add_parameter_tables(report, robot, identification);
  add_extras_table(report, robot, identification);
  report.heading("Base parameters");
  add_base_parameters(report, identification);
  report.heading("Residual");
  add_structure_table(report, residual_structure(training));
  add_residual_over(report, robot, training, Coordinate::velocity);
  add_residual_spectra(report, robot, training);
  report.heading("Mass matrix");
  add_mass_matrix(report, robot, survey);
  report.heading("Data and settings");
  add_motion_table(report, robot, training);
  add_cutoff_figure(report, identification);
  add_regularization_figure(report, identification.fit);
  add_settings(report, robot, identification, training, context);
  report.footer(context.command_line);
  return report.str();
}

}  // namespace deltadyn
