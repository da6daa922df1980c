/// \file
/// delta-validate: how well parameters predict the torque of logs that took no part in the fit.

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <string>
#include <vector>

#include "deltadyn/identification/residual_structure.hpp"
#include "deltadyn/identification/written_model.hpp"
#include "deltadyn/io/extra_rows.hpp"
#include "deltadyn/io/output_file.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/report/log_report.hpp"
#include "deltadyn/report/plot.hpp"
#include "deltadyn/report/validation_report.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/signal/log_columns.hpp"

#include "fine_delay.hpp"
#include "given_effects.hpp"
#include "log_gate.hpp"
#include "processing_flags.hpp"
#include "tool_support.hpp"

namespace {

using namespace deltadyn;
using tools::ToolRun;

class Validate {
 public:
  Validate(int argc, char** argv) : command_line_(tools::command_line(argc, argv)) {}

  void add_to(CLI::App& app, ToolRun& run) {
    app.add_option("robot", robot_file_, "robot file (URDF)")->required()->type_name("ROBOT");
    app.add_option("logs", log_files_,
                   "logs of this robot that were not used for the fit (CSV, or what delta-log import reads)")
        ->required()
        ->type_name("LOG");
    app.add_option("--params", parameter_file_, "parameters name,value,unit (CSV)")->required()->type_name("FILE");
    app.add_option("--effects", effect_file_, "effects that belong to the model (CSV)")->type_name("FILE");
    app.add_option("-o,--output", output_, "residuals t_s, tau, model, residual and state of each drive (CSV)")
        ->type_name("FILE");
    app.add_option("--report", report_file_, "report (HTML)")->type_name("FILE");
    gate_.add_to(app);
    processing_.add_to(app);
    run.on(app, [this, &run] { return execute(run); });
  }

 private:
  ExitCode execute(ToolRun& run) {
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::string> inputs = log_files_;
    inputs.insert(inputs.end(), {robot_file_, parameter_file_, effect_file_});
    run.check_files({output_, report_file_}, inputs);
    if (!report_file_.empty() && !gnuplot_available()) {
      throw Error("the report needs gnuplot", "", "install gnuplot-nox, or leave out --report", ExitCode::usage);
    }
    const RobotDescription description = read_robot_file(robot_file_);
    const ParameterTable table = read_parameters(parameter_file_, description);
    const auto robot = make_robot(description, parameter_options_of(table, description));
    const ParameterMatch match = match_parameters(table, robot->parameter_names(), robot->parameter_units());
    for (const std::string& warning : match.warnings) fmt::print("note: {}\n", warning);
    WrittenModel model;
    model.p = match.value;
    model.effects = tools::given_effects(effect_file_, table, description);
    model.presliding = presliding_of(table, description);
    model.presliding_damping_s = presliding_damping_of(table, description);
    model.ripples = ripples_of(table, description);
    if (holds_timing(model.effects)) gate_.keep_delays();
    if (!model.effects.empty()) gate_.leave_offsets();
    // The model under test is no prior: a wrong one must show in the residual, not in the check of the logs.
    const GateResult gate = gate_.run(*robot, processing_.read_logs(log_files_, description), {}, {}, false,
                                      !processing_.options().filter, run.summary);
    ReportContext context{robot_file_, log_files_, parameter_file_, command_line_, tools::all_findings(gate)};
    std::vector<LogFinding>& findings = context.findings;
    if (gate.stop()) return tools::LogGate::refuse(*robot, gate, context, report_file_, "delta-validate");
    WrittenValidation written = validate_written(*robot, gate.logs, model, processing_.options(),
                                                 processing_.automatic_cutoff(), gate_.keeps_delay());
    if (written.fine_delay) findings.push_back(tools::tell_fine_delay(*written.fine_delay, run.summary));
    const std::vector<Log>& logs = written.logs;
    Validation& result = written.validation;
    if (!output_.empty()) write_residuals(description, logs, result);
    if (!report_file_.empty()) write_file(report_file_, validation_report(*robot, result, match.value, context));
    Assessment assessment = assess_validation(*robot, result);
    weigh_findings(findings, assessment);
    tell(description, result, run);
    run.summary.add("verdict", tools::verdict_word(assessment.verdict));
    run.summary.add("total_time_s", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                    "s");
    tools::print_assessment(assessment);
    tools::point_to_diagnosis(assessment, findings,
                              {robot_file_, parameter_file_, {}, log_files_.front(), processing_.reading_flags()});
    run.summary.add("structure_left", assessment.structure ? "yes" : "no");
    return gate.fault() ? ExitCode::not_trusted : ExitCode::done;
  }

  void write_residuals(const RobotDescription& robot, const std::vector<Log>& logs, const Validation& result) const {
    OutputFile file(output_);
    const int n = robot.drives();
    const bool numbered = log_files_.size() > 1;
    std::string header = numbered ? "log,t_s" : "t_s";
    for (int j = 0; j < n; ++j) {
      const DriveColumns names = drive_columns(robot, j);
      const std::string unit = names.tau.substr(names.tau.find('_'));
      header += fmt::format(",{0},model{1}{2},residual{1}{2},{3},{4},{5},reversal{1}", names.tau, j + 1, unit, names.q,
                            names.qd, names.qdd);
    }
    file.write(header + "\n");
    int number = 0;
    for (std::size_t k = 0; k < result.logs.size(); ++k) {
      const Prediction& p = result.logs[k].prediction;
      if (logs[k].part <= 1) ++number;  // the parts of a log have its number
      for (Eigen::Index row = 0; row < p.rows(); ++row) {
        if ((p.use.row(row) == RowUse::unusable).all()) continue;
        if (numbered) file.print("{},", number);
        file.print("{}", p.t_s(row));
        for (int j = 0; j < n; ++j) {
          file.print(",{},{},{},{},{},{},{}", p.tau(row, j), p.model(row, j), p.tau(row, j) - p.model(row, j),
                     p.q(row, j), p.qd(row, j), p.qdd(row, j), p.use(row, j) == RowUse::regular ? 0 : 1);
        }
        file.write("\n");
      }
    }
    file.commit();
  }

  void tell(const RobotDescription& robot, const Validation& result, ToolRun& run) const {
    Summary& out = run.summary;
    Eigen::Index samples = 0;
    for (const ValidatedLog& log : result.logs) {
      samples += log.samples;
      for (const std::string& note : log.notes) fmt::print("note: {}\n", note);
    }
    out.add("samples", samples);
    if (result.processing.filter) {
      fmt::print("{} samples, motion filtered at {:.4g} Hz\n", samples, result.processing.cutoff_hz);
      out.add("cutoff_hz", result.processing.cutoff_hz, "Hz");
    } else {
      fmt::print("{} samples, taken as they are\n", samples);
    }
    fmt::print("drive   rms residual   of torque   largest   with reversals   rows (near reversals)\n");
    for (int j = 0; j < robot.drives(); ++j) {
      const ValidatedDrive& drive = result.drives[static_cast<std::size_t>(j)];
      const char* unit = tools::torque_unit(robot, j);
      fmt::print("{:>5}   {:>8.4g} {:<3}   {:>6.2f} %   {:>8.4g}   {:>8.4g} {:<3}     {:>9} ({})\n", j + 1,
                 drive.rms_residual, unit, 100 * drive.relative_residual, drive.max_residual, drive.rms_with_reversals,
                 unit, drive.rows, drive.reversal_rows);
      out.add(fmt::format("rms_residual_drive{}", j + 1), drive.rms_residual, unit);
      out.add(fmt::format("relative_residual_drive{}", j + 1), drive.relative_residual);
      out.add(fmt::format("max_residual_drive{}", j + 1), drive.max_residual, unit);
      out.add(fmt::format("rms_with_reversals_drive{}", j + 1), drive.rms_with_reversals, unit);
      out.add(fmt::format("rows_drive{}", j + 1), drive.rows);
    }
    if (!output_.empty()) fmt::print("wrote {}\n", output_);
    if (!report_file_.empty()) fmt::print("wrote {}\n", report_file_);
  }

  std::string command_line_, robot_file_, output_, report_file_, parameter_file_, effect_file_;
  std::vector<std::string> log_files_;
  tools::ProcessingFlags processing_;
  tools::LogGate gate_;
};

}  // namespace

int main(int argc, char** argv) {
  Validate validate(argc, argv);
  return tools::run_tool(
      argc, argv,
      {"delta-validate",
       "Predict the torque of logs that took no part in the fit, and show where model and measurement differ.",
       "delta-validate robot.urdf --params params.csv verification.csv -o residuals.csv --report validation.html"},
      [&](CLI::App& app, ToolRun& run) { validate.add_to(app, run); });
}
