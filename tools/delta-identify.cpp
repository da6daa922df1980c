/// \file
/// delta-identify: base parameters and the physically consistent set from drive logs.

#include <cmath>
#include <fmt/format.h>
#include <string>
#include <vector>

#include "deltadyn/identification/effect_torque.hpp"
#include "deltadyn/identification/identify.hpp"
#include "deltadyn/identification/mass_matrix_survey.hpp"
#include "deltadyn/identification/written_model.hpp"
#include "deltadyn/io/effect_file.hpp"
#include "deltadyn/io/output_file.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/report/assessment.hpp"
#include "deltadyn/report/identification_report.hpp"
#include "deltadyn/report/log_report.hpp"
#include "deltadyn/report/plot.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "fine_delay.hpp"
#include "given_effects.hpp"
#include "identified_extras.hpp"
#include "layout_flags.hpp"
#include "log_gate.hpp"
#include "parameter_tables.hpp"
#include "prior_reading.hpp"
#include "processing_flags.hpp"
#include "tool_support.hpp"

namespace {

using namespace deltadyn;
using tools::ToolRun;

constexpr int kSurveyStates = 2000;  // poses at which M is factored; enough to see the workspace, a few milliseconds

class Identify {
 public:
  Identify(int argc, char** argv) : command_line_(tools::command_line(argc, argv)) {}

  void add_to(CLI::App& app, ToolRun& run) {
    app.add_option("robot", robot_file_, "robot file (URDF)")->required()->type_name("ROBOT");
    app.add_option("logs", log_files_,
                   "logs of this robot (CSV t_s, q1_rad.., tau1_Nm.., or what delta-log import reads)")
        ->required()
        ->type_name("LOG");
    app.add_option("-o,--output", output_, "parameters name,value,unit,std,prior,data_share (CSV)")
        ->required()
        ->type_name("FILE");
    app.add_option("--base", base_file_, "base parameters index,expression,value,unit,std,relative_std_percent (CSV)")
        ->type_name("FILE");
    app.add_option("--report", report_file_, "report (HTML)")->type_name("FILE");
    app.add_option("--prior", prior_file_,
                   "prior parameters name,value,unit[,std] (CSV) [simple shapes, as delta-model prior]")
        ->type_name("FILE");
    app.add_option("--effects", effect_file_,
                   "effects that the model holds (CSV); their amplitudes are estimated along")
        ->type_name("FILE");
    app.add_option("--effects-out", effects_out_, "the effects with their new amplitudes (CSV)")->type_name("FILE");
    app.add_option("--parameters", set_, "reduced: section VI of the paper; full: ten a body")
        ->check(CLI::IsMember({"reduced", "full"}))
        ->capture_default_str();
    app.add_option("--metric", metric_, "distance to the prior: relative (15), bregman or riemannian (frame-invariant)")
        ->check(CLI::IsMember({"relative", "bregman", "riemannian"}))
        ->capture_default_str();
    app.add_option("--regularization", regularization_, "weight of the prior beside chi^2, or auto: from the data")
        ->capture_default_str();
    layout_.add_to(app, "1 for an axis that turns");
    app.add_option(
           "--reversals", reversals_,
           "rows near velocity reversals; auto: used where the build-up of friction is found or Coulomb's law holds, "
           "else left out (mask)")
        ->check(CLI::IsMember({"auto", "mask", "keep"}))
        ->capture_default_str();
    app.add_option("--ripples", ripples_,
                   "auto: waves of the torque over the position are found and belong to the model; none")
        ->check(CLI::IsMember({"auto", "none"}))
        ->capture_default_str();
    app.add_flag("--robust", robust_, "Huber weights against single bad samples");
    gate_.add_to(app);
    processing_.add_to(app);
    run.on(app, [this, &run] { return execute(run); });
  }

 private:
  ExitCode execute(ToolRun& run) {
    std::vector<std::string> inputs = log_files_;
    inputs.insert(inputs.end(), {robot_file_, prior_file_, effect_file_});
    run.check_files({output_, base_file_, report_file_, effects_out_}, inputs);
    if (!report_file_.empty() && !gnuplot_available()) {
      throw Error("the report needs gnuplot", "", "install gnuplot-nox, or leave out --report", ExitCode::usage);
    }
    const RobotDescription description = read_robot_file(robot_file_);
    const auto robot = make_robot(description, parameter_options(description));
    const IdentificationOptions options = identification_options(run);
    const tools::Prior prior = tools::read_prior(*robot, prior_file_);
    std::vector<Effect> effects = tools::given_effects(effect_file_, prior.table, description);
    if (holds_timing(effects)) gate_.keep_delays();
    if (!effects.empty()) gate_.leave_offsets();
    const GateResult gate = gate_.run(*robot, processing_.read_logs(log_files_, description), prior.value, prior.std,
                                      !prior_file_.empty(), !options.processing.filter, run.summary);
    ReportContext context{robot_file_, log_files_, prior_file_, command_line_, tools::all_findings(gate)};
    std::vector<LogFinding>& findings = context.findings;
    if (gate.stop()) return tools::LogGate::refuse(*robot, gate, context, report_file_, "delta-identify");
    std::vector<Log> logs = gate.logs;
    tools::ProgressBar bar("identifying");
    IdentificationOptions with_progress = options;
    with_progress.progress = [&bar](double share) { bar.update(share); };
    Identification result;
    try {
      result = identify_from(*robot, logs, prior.value, prior.std, with_progress, effects);
    } catch (const Error& e) {
      // That a faulty log does not let the fit converge is not the news.
      if (!gate.fault() || e.code() != ExitCode::no_convergence) throw;
      return tools::LogGate::refuse(*robot, gate, context, report_file_, "delta-identify");
    }
    if (effects.empty() && !gate_.keeps_delay()) {
      if (const auto found = tools::mend_fine_delay(*robot, result.base, result.processing, logs, run.summary)) {
        findings.push_back(*found);
        result = identify_from(*robot, logs, prior.value, prior.std, options, effects);
      }
    }
    if (!effects.empty()) tell_effects(description, effects);
    if (!effects_out_.empty()) write_effects(effects_out_, effects, description);
    const MassMatrixSurvey survey = survey_mass_matrix(*robot, result.fit.p, kSurveyStates, run.seed);

    const Validation training = validate_with_effects(*robot, logs, effects, result.fit.p, result.processing);
    Assessment assessment = assess_identification(*robot, result, survey, gather_evidence(*robot, result, training));
    weigh_findings(findings, assessment);
    ParameterTable table = tools::parameter_table(*robot, result);
    if (assessment.verdict == Verdict::bad) table.remark = "NOT TO BE TRUSTED. " + assessment.headline;
    if (!effects.empty()) table.effects = effects_out_.empty() ? effect_file_ : effects_out_;
    write_parameters(output_, table);
    if (!base_file_.empty()) write_base(result);
    if (!report_file_.empty())
      write_file(report_file_, identification_report(*robot, result, training, survey, context));
    const ExitCode code = tell(*robot, result, survey, assessment, run);
    tools::point_to_diagnosis(assessment, findings,
                              {robot_file_, output_, log_files_, "", processing_.reading_flags()});
    return code;
  }

  /// The fit knows that a prior is impossible, but not the file that it came from.
  Identification identify_from(const Robot& robot, const std::vector<Log>& logs, const Eigen::VectorXd& prior,
                               const Eigen::VectorXd& prior_std, const IdentificationOptions& options,
                               std::vector<Effect>& effects) const {
    const std::string mark = "prior, ";
    try {
      return identify_with_effects(robot, logs, prior, prior_std, options, effects);
    } catch (const Error& e) {
      if (e.code() == ExitCode::no_convergence) {
        throw Error(
            e.problem(), e.where(),
            "the logs hardly belong to this robot: check the lengths in the robot file (delta-model info shows them), "
            "then sign, unit "
            "and order of the drives (delta-log check)",
            e.code());
      }
      if (prior_file_.empty() || e.where().rfind(mark, 0) != 0) throw;
      throw Error(e.problem(), prior_file_ + ", " + e.where().substr(mark.size()), e.mend(), e.code());
    }
  }

  static void tell_effects(const RobotDescription& robot, const std::vector<Effect>& effects) {
    for (const Effect& effect : effects) {
      const EffectKind& kind = effect_kind(effect.id);
      for (std::size_t k = 0; k < kind.amplitudes.size(); ++k) {
        const auto at = static_cast<Eigen::Index>(k);
        fmt::print("{} at {}: {} {:.5g} +- {:.2g} {}\n", kind.name, effect_joint_name(effect.id, effect.joint),
                   kind.amplitudes[k].name, effect.amplitude(at), effect.amplitude_std(at),
                   effect_unit(kind.amplitudes[k].unit, effect.joint, robot));
      }
    }
  }

  [[nodiscard]] ParameterOptions parameter_options(const RobotDescription& robot) const {
    ParameterOptions options = layout_.options(robot);
    // A drive on its test bench has its motor's reflected inertia (a carriage's mass is one with it).
    if (robot.type == Axis::kName && robot.drive_kind == DriveKind::revolute && options.rotor_inertia.empty())
      options.rotor_inertia = {1};
    return options;
  }

  IdentificationOptions identification_options(const ToolRun& run) const {
    IdentificationOptions options;
    options.processing = processing_.options();
    options.choose_cutoff = processing_.automatic_cutoff();
    options.reversals =
        reversals_ == "mask" ? Reversals::mask : (reversals_ == "keep" ? Reversals::keep : Reversals::automatic);
    options.find_ripples = ripples_ == "auto";
    options.robust = robust_;
    options.base.seed = run.seed;
    options.fit.set = set_ == "full" ? ParameterSet::full : ParameterSet::reduced;
    options.fit.metric = metric_ == "bregman" ? FitMetric::bregman
                                              : (metric_ == "riemannian" ? FitMetric::riemannian : FitMetric::relative);
    if (regularization_ != "auto") {
      options.fit.regularization = tools::number_of(regularization_, "--regularization", "auto");
      if (!(*options.fit.regularization > 0)) {
        throw Error("--regularization must be above 0", "", "give a weight such as 0.01, or auto", ExitCode::usage);
      }
    }
    return options;
  }

  void write_base(const Identification& result) const {
    OutputFile file(base_file_);
    file.write("index,expression,value,unit,std,relative_std_percent\n");
    const Eigen::VectorXd std = result.base_estimate.std();
    for (int k = 0; k < result.base.count(); ++k) {
      const double value = result.base_estimate.value(k);
      const auto at = static_cast<std::size_t>(k);
      file.print("{},{},{},{},{},{}\n", k + 1, result.base.expressions[at], value, result.base.units[at], std(k),
                 100 * std(k) / std::max(std::abs(value), 1e-300));
    }
    file.commit();
  }

  ExitCode tell(const Robot& robot, const Identification& result, const MassMatrixSurvey& survey,
                const Assessment& assessment, ToolRun& run) const {
    const int columns = robot.parameters();
    Summary& out = run.summary;
    for (const std::string& note : result.notes) fmt::print("note: {}\n", note);
    for (const std::string& note : result.fit.notes) fmt::print("note: {}\n", note);
    fmt::print(
        "{} samples, {} of {} parameters are identifiable combinations (base parameters), condition number {:.4g}\n",
        result.samples, result.base.count(), columns, result.base_estimate.condition_number);
    if (result.processing.filter) {
      fmt::print("motion and torque used up to {:.4g} Hz{}\n", result.processing.cutoff_hz,
                 result.cutoff ? ", chosen from the logs" : "");
      if (const ModelBandPart* end = result.model_band ? result.model_band->beyond() : nullptr; end != nullptr) {
        fmt::print("  above, the torque is not that of this model: {:.2g} ({:.1g}) times it from {:.3g} to {:.3g} Hz\n",
                   end->found, end->std, end->low_hz, end->high_hz);
      }
    }
    tools::tell_extra_rows(robot.description(), result, out);
    out.add("samples", result.samples);
    out.add("columns", columns);
    out.add("base_parameters", result.base.count());
    out.add("condition_number", result.base_estimate.condition_number);
    out.add("log_det", result.base_estimate.log_det);
    if (result.processing.filter) out.add("cutoff_hz", result.processing.cutoff_hz, "Hz");
    fmt::print("drive   rms residual   of torque   base parameters alone   rows used   left out near reversals\n");
    for (int j = 0; j < robot.drives(); ++j) {
      const DriveReport& drive = result.drives[static_cast<std::size_t>(j)];
      const char* unit = tools::torque_unit(robot.description(), j);
      const double relative = drive.rms / std::max(drive.rms_torque, 1e-300);
      fmt::print("{:>5}   {:>8.4g} {:<3}   {:>6.2f} %    {:>8.4g} {:<3}        {:>9}   {:>6.1f} %\n", j + 1, drive.rms,
                 unit, 100 * relative, drive.rms_base, unit, drive.rows,
                 100.0 * static_cast<double>(drive.masked_rows) /
                     static_cast<double>(std::max<Eigen::Index>(1, drive.rows + drive.masked_rows)));
      out.add(fmt::format("rms_residual_drive{}", j + 1), drive.rms, unit);
      out.add(fmt::format("relative_residual_drive{}", j + 1), relative);
      out.add(fmt::format("rms_residual_base_drive{}", j + 1), drive.rms_base, unit);
      out.add(fmt::format("rows_drive{}", j + 1), drive.rows);
    }
    fmt::print("{}\n", result.fit.brief_report());
    out.add("variables", result.fit.variables);
    out.add("regularization", result.fit.lambda);
    out.add("chi_square_rise", result.fit.data_cost - result.fit.data_cost_min);
    out.add("certificate_passed",
            result.fit.certificate.passed ? "yes" : (result.fit.certificate.available ? "no" : "not available"));
    out.add("certificate_gap", result.fit.certificate.gap);
    out.add("mass_matrix_min_eigenvalue", survey.min_eigenvalue,
            robot.drives() > 0 && robot.description().kind_of_drive(0) == DriveKind::revolute ? "kg*m^2" : "kg");
    out.add("fold_time_s", result.fold_time_s, "s");
    out.add("solve_time_s", result.fit.solve_time_s, "s");
    out.add("total_time_s", result.total_time_s, "s");
    fmt::print("smallest eigenvalue of the mass matrix over {} poses: {:.4g}\n", survey.states, survey.min_eigenvalue);
    fmt::print("wrote {}{}{}\n", output_, base_file_.empty() ? "" : ", " + base_file_,
               report_file_.empty() ? "" : ", " + report_file_);
    if (!result.fit.converged && !result.fit.agrees_with_least_squares()) {
      throw Error("the consistent fit did not converge: " + result.fit.message, "",
                  "look at the report; try --regularization with a larger value", ExitCode::no_convergence);
    }
    out.add("verdict", tools::verdict_word(assessment.verdict));
    tools::print_assessment(assessment);
    if (assessment.verdict == Verdict::bad)
      fmt::print(stderr, "  {} is there to be looked at, not to be used\n", output_);
    out.add("structure_left", assessment.structure ? "yes" : "no");
    return assessment.verdict == Verdict::bad ? ExitCode::not_trusted : ExitCode::done;
  }

  std::string command_line_, robot_file_, output_, base_file_, report_file_, prior_file_, effect_file_, effects_out_;
  std::vector<std::string> log_files_;
  std::string set_ = "reduced", metric_ = "relative", regularization_ = "auto", reversals_ = "auto", ripples_ = "auto";
  bool robust_ = false;
  tools::LayoutFlags layout_;
  tools::ProcessingFlags processing_;
  tools::LogGate gate_;
};

}  // namespace

int main(int argc, char** argv) {
  Identify identify(argc, argv);
  return tools::run_tool(argc, argv,
                         {"delta-identify",
                          "Identify the dynamic parameters of a Delta-like robot from drive logs: base parameters by "
                          "weighted least squares "
                          "and a complete, physically consistent set.",
                          "delta-identify robot.urdf fast.csv slow.csv --prior prior.csv -o params.csv --base base.csv "
                          "--report report.html"},
                         [&](CLI::App& app, ToolRun& run) { identify.add_to(app, run); });
}
