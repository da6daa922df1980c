/// \file
/// delta-excite: the motion that shows every parameter, inside the limits of the machine.

#include <atomic>
#include <csignal>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <vector>

#include "deltadyn/excitation/predicted_uncertainty.hpp"
#include "deltadyn/io/coefficient_file.hpp"
#include "deltadyn/io/output_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/io/trajectory_file.hpp"
#include "deltadyn/report/excitation_report.hpp"
#include "deltadyn/report/plot.hpp"

#include "excite/limit_flags.hpp"
#include "excite/planned_motion.hpp"
#include "excite/search_flags.hpp"
#include "excite/telling.hpp"
#include "excite/time_budget.hpp"
#include "excite/torque_flags.hpp"
#include "layout_flags.hpp"
#include "processing_flags.hpp"
#include "tool_support.hpp"

namespace {

using namespace deltadyn;
using Eigen::VectorXd;
using tools::PlannedMotion;
using tools::ToolRun;

constexpr std::uint64_t kValidationSeed = 0x5A11DA7E;

std::atomic<bool> interrupted{false};

/// The first Ctrl-C ends the search with the best motion so far, the second one the tool.
void on_interrupt(int) {
  interrupted = true;
  std::signal(SIGINT, SIG_DFL);
}

class Excite {
 public:
  Excite(int argc, char** argv) : command_line_(tools::command_line(argc, argv)) {}

  void add_to(CLI::App& app, ToolRun& run) {
    app.add_option("robot", robot_file_, "robot file (URDF)")->required()->type_name("ROBOT");
    app.add_option("-o,--output", output_,
                   "trajectory t_s,x_m,..,xd_m_s,..,q1_rad,..,qd1_rad_s,..,qdd1_rad_s2,.. (CSV)")
        ->required()
        ->type_name("FILE");
    app.add_option("--coefficients", coefficients_, "coefficients of the Fourier series (CSV)")->type_name("FILE");
    app.add_option("--validation", validation_, "a second trajectory from other starts, to check the model on (CSV)")
        ->type_name("FILE");
    app.add_option("--report", report_file_, "report (HTML)")->type_name("FILE");
    limits_.add_to(app);
    torque_.add_to(app);
    search_.add_to(app);
    app.option_defaults()->group("Parameters of the model");
    layout_.add_to(app, "none");
    run.on(app, [this, &run] { return execute(run); });
  }

 private:
  /// What a search needs to know.
  struct Problem {
    const Robot& robot;
    const MotionLimits& limits;
    const DesignSpace& space;
    const DesignBound& bound;
  };

  ExitCode execute(ToolRun& run) {
    tools::TimeBudget budget(search_, {torque_.has_model(), !validation_.empty(), !report_file_.empty()});
    check_files(run);
    const RobotDescription description = read_robot_file(robot_file_);
    const auto robot = make_robot(description, layout_.options(description));
    ExcitationOptions options = search_.options(run.seed, description.plate.has_value());
    const NominalParameters nominal = nominal_parameters(*robot, PartShapes(description));
    const NominalParameters model = torque_.has_model() ? torque_.model(*robot) : nominal;
    MotionLimits limits = limits_.limits(*robot, torque_.has_model() ? &model.value : nullptr);
    if (torque_.has_model()) torque_.keep_margin(*robot, model, limits);
    const BaseParameters base = find_base_parameters(*robot);
    const VectorXd scale = torque_.scale(*robot, nominal.value);
    if (torque_.has_model()) tools::TorqueFlags::tell_scale_below_friction(*robot, model.value, scale);
    const VectorXd noise = torque_.noise(*robot, scale);
    const DesignSpace space =
        make_design_space(*robot, limits, base.independent, scale, search_.bound_states(), run.seed);
    const DesignBound bound = design_bound(space);
    const Problem problem{*robot, limits, space, bound};

    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
    tools::ProgressBar bar("looking for the best motion");
    options.stop = &interrupted;
    options.progress = [&bar](double share) { bar.update(share); };
    budget.plan_first(options);
    const PlannedMotion main = search(problem, options);
    write_motion(*robot, main, options.rate_hz);
    const std::optional<PlannedMotion> second = second_motion(problem, options, budget);

    ExcitationReportInput input{*robot,    base,       main.excitation, main.segments,
                                main.plan, main.check, main.samples,    bound};
    expect(input, model.value, nominal.std, noise);
    if (second) input.validation = &second->samples;
    if (options.reversal_reach_s > 0) {
      input.away_from_reversals = tools::away_from_reversals(*robot, main.segments, options);
      input.least_away = options.least_away;
      input.reversal_cutoff_hz = search_.cutoff_hz();
    }
    if (!report_file_.empty()) write_report(input);
    tell(input, options, second ? &*second : nullptr, budget.seconds(), run.summary);
    return ExitCode::done;
  }

  void check_files(const ToolRun& run) const {
    std::vector<std::string> outputs = {output_, coefficients_, validation_, report_file_};
    const std::vector<std::string> own_files = search_.segment_file_names(output_);
    outputs.insert(outputs.end(), own_files.begin(), own_files.end());
    run.check_files(outputs, {robot_file_, torque_.model_file()});
    if (!report_file_.empty() && !gnuplot_available())
      throw Error("the report needs gnuplot", "", "install gnuplot-nox, or leave out --report", ExitCode::usage);
  }

  [[nodiscard]] PlannedMotion search(const Problem& problem, const ExcitationOptions& options) const {
    return tools::plan_excitation(problem.space, problem.limits, problem.bound, options, problem.robot,
                                  search_.duration_s(), search_.periodic());
  }

  void write_motion(const Robot& robot, const PlannedMotion& motion, double rate_hz) const {
    write_trajectory(output_, motion.samples, robot.description());
    const std::vector<std::string> own_files = search_.segment_file_names(output_);
    for (std::size_t k = 0; k < own_files.size(); ++k) {
      const MotionPlan plan = make_plan(robot, {motion.segments[k]}, rate_hz, search_.periodic());
      write_trajectory(own_files[k], sample_plan(robot, plan, rate_hz), robot.description());
    }
    if (coefficients_.empty()) return;
    std::vector<FourierSeries> series;
    for (const Excitation::Segment& segment : motion.excitation.segments) series.push_back(segment.series);
    write_coefficients(coefficients_, series, robot.description());
  }

  /// The motion to check the model on, if it is asked for.
  [[nodiscard]] std::optional<PlannedMotion> second_motion(const Problem& problem, const ExcitationOptions& first,
                                                           const tools::TimeBudget& budget) const {
    if (validation_.empty()) return std::nullopt;
    ExcitationOptions options = first;
    options.seed = first.seed ^ kValidationSeed;
    budget.plan_second(options);
    PlannedMotion motion = search(problem, options);
    write_trajectory(validation_, motion.samples, problem.robot.description());
    return motion;
  }

  /// What an identification on the motion is to come to.
  void expect(ExcitationReportInput& input, const VectorXd& parameters, const VectorXd& nominal_std,
              const VectorXd& noise) const {
    const BaseParameters& base = input.base;
    input.torque_noise = noise;
    input.predicted_std = predicted_std(input.robot, base.independent, input.samples, noise);
    input.base_values = base.B * parameters;
    const VectorXd spread_of_base = (base.B.cwiseAbs2() * nominal_std.cwiseAbs2()).cwiseSqrt();
    input.base_scale = input.base_values.cwiseAbs().cwiseMax(spread_of_base);
    input.values_are_nominal = !torque_.has_model();
  }

  void write_report(const ExcitationReportInput& input) const {
    ReportContext context;
    context.robot_file = robot_file_;
    context.parameter_file = torque_.model_file();
    context.command_line = command_line_;
    write_file(report_file_, excitation_report(input, context));
  }

  void tell(const ExcitationReportInput& input, const ExcitationOptions& options, const PlannedMotion* validation,
            double total_s, Summary& out) const {
    tools::tell_motion(input, options, out);
    tools::tell_reversals(input.away_from_reversals, "", search_.cutoff_hz(), out);
    if (validation != nullptr && options.reversal_reach_s > 0)
      tools::tell_reversals(tools::away_from_reversals(input.robot, validation->segments, options), "validation",
                            search_.cutoff_hz(), out);
    tools::summarise_motion(input, search_.criterion(), total_s, out);
    if (validation != nullptr) out.add("validation_d_efficiency", validation->excitation.d_efficiency);
    const Assessment assessment = assess_excitation(input);
    out.add("verdict", tools::verdict_word(assessment.verdict));
    std::string written = output_;
    for (const std::string& file : search_.segment_file_names(output_)) written += ", " + file;
    for (const std::string& file : {coefficients_, validation_, report_file_})
      written += file.empty() ? "" : ", " + file;
    fmt::print("wrote {}\n", written);
    tools::print_assessment(assessment);
  }

  std::string command_line_, robot_file_, output_, coefficients_, validation_, report_file_;
  tools::LimitFlags limits_;
  tools::TorqueFlags torque_;
  tools::SearchFlags search_;
  tools::LayoutFlags layout_;
};

}  // namespace

int main(int argc, char** argv) {
  Excite excite(argc, argv);
  return tools::run_tool(
      argc, argv,
      {"delta-excite",
       "Find the motion that shows every dynamic parameter of a Delta-like robot as well as possible inside the limits "
       "of the "
       "machine. Ctrl-C ends the search with the best motion so far.",
       "delta-excite robot.urdf -o trajectory.csv --workspace half-ball --workspace-center-m 0,0,-0.80 \\\n"
       "      --workspace-radius-m 0.35 --platform-velocity-m-s 4 --platform-acceleration-m-s2 50 --torque-scale "
       "60,60,60,4 \\\n"
       "      --coefficients coefficients.csv --validation validation.csv --report excitation.html"},
      [&](CLI::App& app, ToolRun& run) { excite.add_to(app, run); });
}
