/// \file
/// delta-diagnose: where a model and its logs disagree, the name of what is missing, the model with it, and the proof.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <optional>
#include <string>
#include <vector>

#include "deltadyn/diagnosis/diagnose.hpp"
#include "deltadyn/diagnosis/next_experiment.hpp"
#include "deltadyn/io/effect_file.hpp"
#include "deltadyn/io/extra_rows.hpp"
#include "deltadyn/io/log_file.hpp"
#include "deltadyn/io/output_file.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/io/trajectory_file.hpp"
#include "deltadyn/report/diagnosis_report.hpp"
#include "deltadyn/report/diagnosis_text.hpp"
#include "deltadyn/report/plot.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "given_effects.hpp"
#include "log_gate.hpp"
#include "parameter_tables.hpp"
#include "processing_flags.hpp"
#include "tool_support.hpp"

namespace {

using namespace deltadyn;
using tools::ToolRun;

class Diagnose {
 public:
  Diagnose(int argc, char** argv) : command_line_(tools::command_line(argc, argv)) {}

  void add_to(CLI::App& app, ToolRun& run) {
    app.add_option("robot", robot_file_, "robot file (URDF)")->type_name("ROBOT");
    app.add_option("logs", log_files_,
                   "training logs of this robot (CSV t_s, q1_rad.., tau1_Nm.., or what delta-log import reads)")
        ->type_name("LOG");
    app.add_option("--params", parameter_file_, "parameters of the model (CSV)")->type_name("FILE");
    app.add_option("--effects", effect_file_, "effects that the model holds already (CSV)")->type_name("FILE");
    app.add_option("--holdout", holdout_file_, "log that takes no part in the search, for the proof (CSV)")
        ->type_name("LOG");
    app.add_option("-o,--output", output_, "diagnosis (CSV), row 1 holds the verdict")->type_name("FILE");
    app.add_option("--effects-out", effects_out_, "effects of the improved model (CSV)")->type_name("FILE");
    app.add_option("--params-out", params_out_, "parameters of the improved model (CSV)")->type_name("FILE");
    app.add_option("--report", report_file_, "report (HTML)")->type_name("FILE");
    app.add_option("--plan-next", plan_file_, "if effects cannot be told apart: trajectory that separates them (CSV)")
        ->type_name("FILE");
    app.add_option("--false-naming-rate", options_.false_naming_rate,
                   "chance of naming an effect where nothing is missing")
        ->capture_default_str();
    app.add_option("--max-effects", options_.max_effects, "most effects named together")->capture_default_str();
    app.add_option("--null-runs", options_.null_runs, "simulated clean logs")->capture_default_str();
    app.add_flag("--list-effects", list_, "print the catalogue of effects and end");
    gate_.add_to(app);
    gate_.leave_delays();
    gate_.leave_offsets();
    processing_.add_to(app);
    run.on(app, [this, &run] { return execute(run); });
  }

 private:
  void require(bool given, const char* what) const {
    if (!given)
      throw Error(std::string(what) + " is required", "", "delta-diagnose --help shows the flags", ExitCode::usage);
  }

  ExitCode execute(ToolRun& run) {
    if (list_) {
      for (const EffectKind& kind : effect_catalogue()) {
        fmt::print("{:<28} {:<18} {}{}\n", kind.name, effect_class_name(kind.effect_class), kind.meaning,
                   kind.alias.empty() ? "" : fmt::format(" (also {})", kind.alias));
      }
      return ExitCode::done;
    }
    require(!robot_file_.empty(), "the robot file");
    require(!log_files_.empty(), "a log");
    require(!parameter_file_.empty(), "--params");
    require(!output_.empty(), "--output");
    std::vector<std::string> inputs = log_files_;
    inputs.insert(inputs.end(), {robot_file_, parameter_file_, effect_file_, holdout_file_});
    run.check_files({output_, effects_out_, params_out_, report_file_, plan_file_}, inputs);
    if (!report_file_.empty() && !gnuplot_available()) {
      throw Error("the report needs gnuplot", "", "install gnuplot-nox, or leave out --report", ExitCode::usage);
    }
    const RobotDescription description = read_robot_file(robot_file_);
    const ParameterTable table = read_parameters(parameter_file_, description);
    ParameterOptions layout = parameter_options_of(table, description);
    // As delta-identify does: a drive on its test bench has its amplifier's offset.
    if (description.type == Axis::kName) layout.offset = true;
    const auto robot = make_robot(description, layout);
    const ParameterMatch match = match_parameters(table, robot->parameter_names(), robot->parameter_units());
    for (const std::string& warning : match.warnings) fmt::print("note: {}\n", warning);
    const std::vector<Effect> known = tools::given_effects(effect_file_, table, description);
    const GateResult gate = check(*robot, log_files_, run);
    const ReportContext context{robot_file_, log_files_, parameter_file_, command_line_, tools::all_findings(gate)};
    if (gate.stop()) return tools::LogGate::refuse(*robot, gate, context, report_file_, "delta-diagnose");
    const std::vector<Log>& logs = gate.logs;
    std::optional<Log> holdout;
    if (!holdout_file_.empty()) {
      // The proof rests on one stretch of motion; of a log with gaps, the longest.
      const GateResult proof = check(*robot, {holdout_file_}, run);
      if (proof.stop()) {
        const ReportContext of_proof{
            robot_file_, {holdout_file_}, parameter_file_, command_line_, tools::all_findings(proof)};
        return tools::LogGate::refuse(*robot, proof, of_proof, report_file_, "delta-diagnose");
      }
      const std::vector<Log>& parts = proof.logs;
      holdout = *std::max_element(parts.begin(), parts.end(),
                                  [](const Log& a, const Log& b) { return a.samples() < b.samples(); });
    }

    options_.processing = processing_.options();
    options_.processing.presliding = presliding_of(table, description);
    options_.processing.presliding_damping_s = presliding_damping_of(table, description);
    options_.processing.ripples = ripples_of(table, description);
    options_.choose_cutoff = processing_.automatic_cutoff();
    options_.seed = run.seed;
    options_.identify = !params_out_.empty();
    options_.prior = match.prior;
    tools::ProgressBar bar("diagnosing");
    options_.progress = [&bar](double share) { bar.update(share); };
    const Diagnosis result = diagnose(*robot, logs, holdout ? &*holdout : nullptr, match.value,
                                      prior_std(*robot, options_.prior), known, options_);

    write_diagnosis(*robot, result);
    if (!effects_out_.empty()) write_effects(effects_out_, result.effects, description);
    if (!params_out_.empty()) write_improved(*robot, table, result);
    if (!plan_file_.empty()) plan_next(*robot, result, match.value, run);
    if (!report_file_.empty()) write_file(report_file_, diagnosis_report(*robot, result, context));
    tell(result, *robot, run);
    return ExitCode::done;
  }

  /// The model under test is no prior of the check.
  GateResult check(const Robot& robot, const std::vector<std::string>& files, ToolRun& run) const {
    return gate_.run(robot, processing_.read_logs(files, robot.description()), {}, {}, false,
                     !processing_.options().filter, run.summary);
  }

  /// Trust in it, as delta-identify has it.
  static Eigen::VectorXd prior_std(const Robot& robot, const Eigen::VectorXd& prior) {
    Eigen::VectorXd std = nominal_parameters(robot, PartShapes(robot.description())).std;
    for (Eigen::Index k = 0; k < std.size(); ++k) {
      if (prior(k) != 0) std(k) = std::max(std(k), 0.5 * std::abs(prior(k)));
    }
    return std;
  }

  static std::string joined(const std::vector<EffectCandidate>& set) {
    std::string text;
    for (const EffectCandidate& one : set) text += (text.empty() ? "" : ";") + one.name + "@" + one.joint;
    return text;
  }

  static std::string clean(std::string text) {
    for (char& c : text) {
      if (c == ',') c = ';';
    }
    return text;
  }

  void write_diagnosis(const Robot& robot, const Diagnosis& result) const {
    OutputFile file(output_);
    file.write(
        "rank,verdict,effect,class,joint,p_value,explained_share,amplitude,amplitude_std,unit,shape_parameters,"
        "confusable_with,"
        "region,rms_before,rms_after,rms_floor\n");
    if (result.named.empty()) {
      file.print("1,{},,,,{},{},,,,,,{},,,\n", verdict_name(result.verdict), result.p_value, result.explained_share,
                 clean(place_text(robot, result)));
    }
    const bool unknown = result.verdict == DiagnosisVerdict::unknown_structure;
    int rank = 0;
    for (const NamedEffect& one : result.named) {
      ++rank;
      const EffectKind& kind = effect_kind(one.effect.id);
      const char* verdict = unknown ? verdict_name(result.verdict)
                                    : (one.confusable.empty() ? verdict_name(DiagnosisVerdict::named)
                                                              : verdict_name(DiagnosisVerdict::confusable));
      if (unknown) {
        // The name that does not suffice is no name: it stands in the report only.
        // Nothing is added to the model, so that its error stays what it was.
        file.print("{},{},,,,{},{},,,,,,{},{},{},{}\n", rank, verdict, result.p_value, result.explained_share,
                   clean(place_text(robot, result)), one.rms_before, one.rms_before, one.rms_floor);
        break;
      }
      std::string shape = effect_shape_text(one.effect, robot.description());
      for (std::size_t k = 1; k < kind.amplitudes.size(); ++k) {
        shape += fmt::format("{}{}={:.6g} {}", shape.empty() ? "" : "; ", kind.amplitudes[k].name,
                             one.effect.amplitude(static_cast<Eigen::Index>(k)),
                             effect_unit(kind.amplitudes[k].unit, one.effect.joint, robot.description()));
      }
      file.print("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", rank,
                 rank == 1 ? verdict_name(result.verdict) : verdict, one.name, one.effect_class, one.joint, one.p_value,
                 one.explained_share, one.effect.amplitude(0),
                 one.effect.amplitude_std.size() > 0 ? one.effect.amplitude_std(0) : 0.0,
                 effect_unit(kind.amplitudes[0].unit, one.effect.joint, robot.description()), clean(shape),
                 joined(one.confusable), clean(region_text(robot, one)), one.rms_before, one.rms_after, one.rms_floor);
    }
    file.commit();
  }

  /// The improved parameters; without a named effect those of the model, so that a chain of tools always finds a file.
  void write_improved(const Robot& robot, const ParameterTable& before, const Diagnosis& result) const {
    ParameterTable table = result.improved ? tools::parameter_table(robot, *result.improved) : before;
    if (!result.effects.empty()) {
      table.effects = !effects_out_.empty() ? effects_out_ : (result.improved ? kEffectsNotWritten : effect_file_);
      if (table.effects == kEffectsNotWritten) {
        fmt::print(stderr,
                   "warning: {} holds only together with the effects that were found: give --effects-out FILE, too\n",
                   params_out_);
      }
    }
    write_parameters(params_out_, table);
  }

  void plan_next(const Robot& robot, const Diagnosis& result, const Eigen::VectorXd& p, const ToolRun& run) const {
    const std::optional<NextExperiment> plan = plan_next_experiment(robot, result, p, run.seed);
    if (!plan) {
      fmt::print("note: {} is not written: there is no set of effects to tell apart\n", plan_file_);
      return;
    }
    write_trajectory(plan_file_, plan->samples, robot.description(), plan->note);
    fmt::print("{}; wrote {}\n", plan->note, plan_file_);
  }

  /// What the rows of the parameter file say is known, and not looked for.
  static void tell_known(const RobotDescription& robot, const ProcessingOptions& known) {
    std::vector<std::string> parts;
    for (Eigen::Index joint = 0; joint < known.presliding.size(); ++joint) {
      if (!(known.presliding(joint) > 0)) continue;
      const auto at = static_cast<int>(joint);
      parts.push_back(fmt::format(
          "friction of {} builds up over {:.3g} {}",
          at < robot.drives() ? fmt::format("drive {}", at + 1) : fmt::format("the {}", robot.inner_joint()),
          known.presliding(joint), tools::joint_turns(robot, at) ? "rad" : "m"));
    }
    for (const Ripple& ripple : known.ripples) {
      parts.push_back(fmt::format("torque of drive {} ripples by {:.3g} {}", ripple.drive + 1,
                                  std::hypot(ripple.cosine, ripple.sine), tools::torque_unit(robot, ripple.drive)));
    }
    if (!parts.empty()) fmt::print("  Known, as the parameter file holds it: {}.\n", fmt::join(parts, "; "));
  }

  /// The written model on the hold-out log, as delta-validate shows it.
  static void tell_proof(const RobotDescription& robot, const Diagnosis& result, Summary& out) {
    for (std::size_t j = 0; j < result.holdout_figures.size(); ++j) {
      const HoldoutFigure& one = result.holdout_figures[j];
      const char* unit = tools::torque_unit(robot, static_cast<int>(j));
      const std::string flag =
          result.holdout_cutoff_hz > 0 ? fmt::format(" --cutoff-hz {:.4g}", result.holdout_cutoff_hz) : std::string();
      fmt::print("  delta-validate{} on the hold-out log, drive {}: {:.4g} {} as given, {:.4g} as written ({} rows)\n",
                 flag, j + 1, one.rms_given, unit, one.rms_written, one.rows_written);
      out.add(fmt::format("holdout_rms_given_drive{}", j + 1), one.rms_given, unit);
      out.add(fmt::format("holdout_rms_written_drive{}", j + 1), one.rms_written, unit);
    }
  }

  /// Rows of each drive that the search rests on, log by log.
  void tell_rows(const Diagnosis& result) const {
    if (result.drives.empty()) return;
    fmt::print("searched up to {:.3g} Hz; rows used whole, and in part beside reversals, of all\n", result.cutoff_hz);
    for (std::size_t l = 0; l < result.drives.front().rows.size(); ++l) {
      std::string text;
      for (std::size_t j = 0; j < result.drives.size(); ++j) {
        const RowCount& rows = result.drives[j].rows[l];
        text += fmt::format("{}drive {}: {} + {}", j > 0 ? ", " : "", j + 1, rows.whole, rows.part);
      }
      const bool held = l + 1 == result.drives.front().rows.size() && !holdout_file_.empty();
      fmt::print("  {} of {} of {}\n", text, result.drives.front().rows[l].all,
                 held ? "the hold-out log" : result.traces[l].file);
    }
  }

  /// The rule that decided, and what it looked at.
  static void tell_reason(const Diagnosis& result, Summary& out) {
    const VerdictFacts& facts = result.facts;
    out.add("reason", reason_name(result.reason));
    if (result.reason == VerdictReason::logs_too_short) return;
    out.add("fact_names", static_cast<int>(facts.names));
    out.add("fact_open_courses", static_cast<int>(facts.open_courses));
    out.add("fact_explained_share", facts.explained_share);
    out.add("fact_structure_left", facts.structure_left);
    out.add("fact_structure_counts", facts.structure_counts ? 1 : 0);
    out.add("fact_holdout_gap", facts.holdout_gap);
    out.add("fact_holdout_left", facts.holdout_left);
    out.add("fact_gap_closed", facts.gap_closed);
    out.add("fact_gap_closed_at_most", facts.gap_closed_at_most);
    out.add("fact_overt", facts.overt ? 1 : 0);
    out.add("fact_slow_drive", facts.slow_drive + 1);
    out.add("fact_missed_drive", facts.missed_drive + 1);
    out.add("fact_base_hidden", facts.base_hidden ? 1 : 0);
  }

  void tell(const Diagnosis& result, const Robot& robot, ToolRun& run) const {
    const DiagnosisText text = diagnosis_text(robot, result);
    fmt::print("{}\n", text.headline);
    for (const std::string& line : text.lines) fmt::print("  {}\n", line);
    const RobotDescription& description = robot.description();
    tell_known(description, options_.processing);
    tell_proof(description, result, run.summary);
    if (const std::string gap = gap_text(result); !gap.empty()) fmt::print("  {}\n", gap);
    for (const std::string& line : text.next) fmt::print("next: {}\n", line);
    for (const std::string& note : text.notes) fmt::print("note: {}\n", note);
    if (!params_out_.empty() && !result.improved)
      fmt::print("note: {} holds the parameters as they were given\n", params_out_);
    tell_rows(result);
    if (!result.drives.empty())
      fmt::print("training logs, rms [N m | N]\ndrive   as given   fitted   with effects   noise floor   structure\n");
    Summary& out = run.summary;
    for (std::size_t j = 0; j < result.drives.size(); ++j) {
      const DriveFit& drive = result.drives[j];
      fmt::print("{:>5}   {:>8.4g}   {:>6.4g}   {:>12.4g}   {:>11.4g}   {:>7.1f} %\n", j + 1, drive.rms_given,
                 drive.rms, drive.rms_after, drive.floor, 100 * drive.structure);
    }
    out.add("verdict", verdict_name(result.verdict));
    tell_reason(result, out);
    const bool name = gives_a_name(result.verdict);
    out.add("effect", name ? result.named.front().name : "");
    out.add("class", name ? result.named.front().effect_class : "");
    out.add("joint", name ? result.named.front().joint : "");
    out.add("effects", name ? static_cast<int>(result.named.size()) : 0);
    out.add("p_value", result.p_value);
    out.add("explained_share", result.explained_share);
    if (name) {
      const Effect& first = result.named.front().effect;
      out.add("amplitude", first.amplitude(0),
              effect_unit(effect_kind(first.id).amplitudes[0].unit, first.joint, description));
      std::vector<EffectCandidate> sets;
      for (const NamedEffect& one : result.named) sets.insert(sets.end(), one.confusable.begin(), one.confusable.end());
      out.add("confusable_with", joined(sets));
    }
    if (std::isfinite(result.gap_shrink)) out.add("gap_shrink", result.gap_shrink);
    if (result.needed_s) out.add("needed_length_s", *result.needed_s, "s");
    if (result.cutoff_hz > 0) out.add("cutoff_hz", result.cutoff_hz, "Hz");
    for (std::size_t j = 0; j < result.drives.size(); ++j) {
      const char* unit = tools::torque_unit(description, static_cast<int>(j));
      out.add(fmt::format("rms_residual_drive{}", j + 1), result.drives[j].rms, unit);
      out.add(fmt::format("rms_floor_drive{}", j + 1), result.drives[j].floor, unit);
      Eigen::Index rows = 0;
      for (std::size_t l = 0; l < result.drives[j].rows.size() - (holdout_file_.empty() ? 0 : 1); ++l)
        rows += result.drives[j].rows[l].whole;
      out.add(fmt::format("rows_drive{}", j + 1), rows);
    }
    out.add("null_runs", result.null_runs);
    out.add("total_time_s", result.total_time_s, "s");
  }

  std::string command_line_, robot_file_, parameter_file_, effect_file_, holdout_file_, output_, effects_out_,
      params_out_, report_file_, plan_file_;
  std::vector<std::string> log_files_;
  DiagnosisOptions options_;
  bool list_ = false;
  tools::ProcessingFlags processing_;
  tools::LogGate gate_;
};

}  // namespace

int main(int argc, char** argv) {
  Diagnose diagnose(argc, argv);
  return tools::run_tool(
      argc, argv,
      {"delta-diagnose",
       "Find which physical effect a model misses: where it fails, the effect's name and size, the model with it, and "
       "the "
       "proof on a log that took no part.",
       "delta-diagnose robot.urdf --params params.csv fast.csv slow.csv --holdout check.csv -o diagnosis.csv "
       "--effects-out effects.csv --params-out improved.csv --report diagnosis.html"},
      [&](CLI::App& app, ToolRun& run) { diagnose.add_to(app, run); });
}
