#include "deltadyn/report/validation_report.hpp"

#include <fmt/format.h>

#include "deltadyn/report/assessment.hpp"
#include "deltadyn/report/format.hpp"
#include "deltadyn/report/log_report.hpp"
#include "deltadyn/runtime/error.hpp"

#include "assessment_parts.hpp"
#include "drive_figures.hpp"
#include "drive_names.hpp"

namespace deltadyn {
namespace {

void add_drive_table(HtmlReport& report, const Robot& robot, const Validation& validation) {
  Table table({text_column("drive"), "rms residual", fmt::format("of the rms {}", units_of(robot, 0).effort),
               "largest residual", "rms with reversals", "rows", "left out near reversals"});
  for (std::size_t j = 0; j < validation.drives.size(); ++j) {
    const ValidatedDrive& drive = validation.drives[j];
    const char* unit = units_of(robot, static_cast<int>(j)).torque;
    const Verdict verdict = grade_residual(drive.relative_residual);
    table.row(
        {drive_name(static_cast<int>(j)), format_number(drive.rms_residual, unit, 3),
         format_percent(drive.relative_residual), format_number(drive.max_residual, unit, 3),
         format_number(drive.rms_with_reversals, unit, 3), format_count(drive.rows), format_count(drive.reversal_rows)},
        verdict == Verdict::good ? Tone::plain : tone_of(verdict));
  }
  report.table(table, "Residual of each drive over all logs.");
  if (validation.logs.size() < 2) return;
  Table by_log({text_column("log"), text_column("drive"), "rms residual",
                fmt::format("of the rms {}", units_of(robot, 0).effort), "rms with reversals"});
  for (const ValidatedLog& log : validation.logs) {
    for (int j = 0; j < robot.drives(); ++j) {
      const double rms = log.prediction.rms_residual(j, false), torque = log.prediction.rms_torque(j, false);
      by_log.row({j == 0 ? short_name(log.file) : "", drive_name(j), format_number(rms, units_of(robot, j).torque, 3),
                  torque > 0 ? format_percent(rms / torque) : "–",
                  format_number(log.prediction.rms_residual(j, true), units_of(robot, j).torque, 3)});
    }
  }
  report.table(by_log, "The same log by log.");
}

}  // namespace

std::string validation_report(const Robot& robot, const Validation& validation, const Eigen::VectorXd& p,
                              const ReportContext& context) {
  if (validation.drives.size() != static_cast<std::size_t>(robot.drives()) || p.size() != robot.parameters()) {
    throw Error("validation and parameters are not those of this robot", robot.description().name,
                "validate with the same robot file", ExitCode::usage);
  }
  Assessment assessment = assess_validation(robot, validation);
  weigh_findings(context.findings, assessment);
  const RobotDescription& description = robot.description();
  HtmlReport report("Validation of " + description.name,
                    fmt::format("{}, {} drives, {}", description.type, description.drives(),
                                counted(std::ssize(validation.logs), "log")));
  report.verdict(assessment.verdict, assessment.headline, assessment.told());
  add_log_check(report, context.findings);
  std::vector<KeyFigure> figures;
  for (std::size_t j = 0; j < validation.drives.size(); ++j) {
    const ValidatedDrive& drive = validation.drives[j];
    figures.push_back(residual_figure(robot, static_cast<int>(j), drive.rms_residual, drive.relative_residual));
  }
  report.key_figures(figures);

  report.heading("Checks");
  add_check_table(report, assessment);
  add_drive_table(report, robot, validation);
  report.heading("Measured and model");
  add_torque_figures(report, robot, validation);
  report.heading("What the residual is made of");
  add_structure_table(report, residual_structure(validation));
  add_residual_over(report, robot, validation, Coordinate::velocity);
  add_residual_over(report, robot, validation, Coordinate::position);
  add_residual_spectra(report, robot, validation);
  report.heading("Data and settings");
  add_motion_table(report, robot, validation);
  report.facts(source_facts(context, "Parameters", context.parameter_file, validation));
  std::vector<std::string> notes;
  for (const ValidatedLog& log : validation.logs) notes.insert(notes.end(), log.notes.begin(), log.notes.end());
  if (!notes.empty()) report.subheading("Notes").list(notes);
  report.details("Parameters of the model", [&](HtmlReport& inside) {
    Table table({text_column("parameter"), "value", text_column("unit")});
    for (Eigen::Index i = 0; i < p.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      table.row({robot.parameter_names()[k], format_number(p(i)), pretty_unit(robot.parameter_units()[k])});
    }
    inside.table(table);
  });
  report.footer(context.command_line);
  return report.str();
}

}  // namespace deltadyn
