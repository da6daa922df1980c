/// \file
/// delta-simulate: the log of a virtual robot that follows a trajectory, with any effect of the catalogue.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include "deltadyn/io/effect_file.hpp"
#include "deltadyn/io/log_file.hpp"
#include "deltadyn/io/output_file.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/io/trajectory_file.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/signal/log_columns.hpp"
#include "deltadyn/simulation/simulate.hpp"

#include "effects_of_rows.hpp"
#include "given_effects.hpp"
#include "simulate/effect_flag.hpp"
#include "tool_support.hpp"

namespace {

using namespace deltadyn;
using tools::ToolRun;

class Simulate {
 public:
  void add_to(CLI::App& app, ToolRun& run) {
    app.add_option("robot", robot_file_, "robot file (URDF)")->required()->type_name("ROBOT");
    app.add_option("--params", parameter_file_, "parameters of the virtual robot name,value,unit (CSV)")
        ->required()
        ->type_name("FILE");
    app.add_option("--trajectory", trajectory_file_, "motion to follow (CSV, as delta-excite writes it)")
        ->required()
        ->type_name("FILE");
    app.add_option("-o,--output", output_, "log t_s, q1_rad.., tau1_Nm.. (CSV)")->required()->type_name("FILE");
    app.add_option("--effect", effects_,
                   "effect NAME@JOINT:key=value,... e.g. " + tools::example_effect() + "; may be given several times")
        ->type_name("TEXT")
        ->take_all();
    app.add_flag_callback(
        "--list-effects",
        [] {
          tools::list_effects();
          throw CLI::Success();
        },
        "print the effects, where each can act and the numbers it takes, and end");
    app.add_option("--effects", effects_file_,
                   "effects as delta-diagnose writes them, effect,joint,parameter,value,unit,std (CSV)")
        ->type_name("FILE");
    app.add_option("--controller", law_, "control law")
        ->check(CLI::IsMember({"pd-feedforward", "computed-torque", "augmented-pd"}))
        ->capture_default_str();
    app.add_option("--controller-params", controller_parameter_file_,
                   "what the controller knows of the robot (CSV) [--params]")
        ->type_name("FILE");
    app.add_flag("--no-feed-forward", no_feed_forward_, "pd-feedforward without its feed-forward");
    app.add_option("--bandwidth-hz", options_.controller.bandwidth_hz, "bandwidth of the position loops [Hz]")
        ->capture_default_str();
    app.add_option("--damping-ratio", options_.controller.damping_ratio, "damping of the position loops")
        ->capture_default_str();
    app.add_option("--kp", options_.controller.kp,
                   "position gain of each drive [N m/rad | N/m] (computed-torque: [1/s^2]) [from --bandwidth-hz]")
        ->delimiter(',');
    app.add_option("--kd", options_.controller.kd,
                   "rate gain of each drive [N m s/rad | N s/m] (computed-torque: [1/s]) [from --bandwidth-hz]")
        ->delimiter(',');
    app.add_option("--rate-filter-hz", options_.controller.rate_filter_hz,
                   "low pass of the differenced position error [Hz]")
        ->capture_default_str();
    app.add_option("--rate-hz", options_.log_rate_hz, "sampling rate of the log [Hz]")->capture_default_str();
    app.add_option("--control-rate-hz", control_rate_hz_,
                   "rate of the controller [Hz], a multiple of --rate-hz [--rate-hz]");
    app.add_option("--current-lag-s", options_.plant.current_lag_s, "time constant of the drives' current loops [s]")
        ->capture_default_str();
    app.add_option("--encoder-bits", encoder_bits_,
                   "resolution of the encoders of revolute drives [bit per turn], 0: exact")
        ->check(CLI::Range(0, 32))
        ->capture_default_str();
    app.add_option("--encoder-step-m", encoder_step_m_, "resolution of the encoders of prismatic drives [m], 0: exact")
        ->capture_default_str();
    app.add_option("--encoder-noise-rad", encoder_noise_,
                   "standard deviation of the encoders [rad | m], one or one a drive")
        ->delimiter(',');
    app.add_option("--torque-noise-n-m", torque_noise_,
                   "standard deviation of the recorded torque [N m | N], one or one a drive")
        ->delimiter(',');
    app.add_option("--torque-noise-correlation", options_.sensors.torque_noise_correlation,
                   "correlation of the torque noise of neighbouring samples, 0: white, below 1")
        ->capture_default_str();
    app.add_option("--repeat", repeats_, "runs of a periodic trajectory")
        ->check(CLI::Range(1, 1000000))
        ->capture_default_str();
    app.add_option("--discard-s", options_.discard_s, "time at the start that does not enter the log [s]")
        ->capture_default_str();
    app.add_option("--tolerance", options_.plant.tolerance, "error of one integration step [rad, m, rad/s, m/s]")
        ->capture_default_str();
    app.add_flag("--inverse", options_.inverse,
                 "no controller: exact motion and the torque that it takes, with qd and qdd");
    app.add_flag("--with-derivatives", with_derivatives_, "write the exact qd and qdd, too");
    run.on(app, [this, &run] { execute(run); });
  }

 private:
  void execute(ToolRun& run) {
    run.check_files({output_},
                    {robot_file_, parameter_file_, trajectory_file_, controller_parameter_file_, effects_file_});
    const RobotDescription description = read_robot_file(robot_file_);
    const ParameterTable table = read_parameters(parameter_file_, description);
    const auto robot = make_robot(description, parameter_options_of(table, description));
    const Eigen::VectorXd p = matched(table, *robot);
    std::vector<Effect> effects = tools::effects_of_rows(table, description);
    std::vector<Effect> given = tools::given_effects(effects_file_, table, description);
    for (const std::string& text : effects_) tools::add_effect(text, description, given);
    std::move(given.begin(), given.end(), std::back_inserter(effects));
    complete_options(description, run);
    const TrajectorySamples motion = read_trajectory(trajectory_file_, *robot);
    tell_of_the_plate(description, motion);
    const ReferenceMotion reference(motion, repeats_);
    Plant plant(description, robot->parameter_names(), p, effects, options_.plant);

    std::unique_ptr<Robot> model;
    Eigen::VectorXd known = p;
    if (!controller_parameter_file_.empty()) {
      const ParameterTable controller_table = read_parameters(controller_parameter_file_, description);
      model = make_robot(description, parameter_options_of(controller_table, description));
      known = matched(controller_table, *model);
    }
    tools::ProgressBar bar("simulating");
    options_.progress = [&bar](double share) { bar.update(share); };
    SimulationResult result = simulate(plant, model ? *model : *robot, known, reference, effects, options_);
    if (!with_derivatives_ && !options_.inverse) {
      result.log.qd.resize(0, 0);
      result.log.qdd.resize(0, 0);
    }
    write_log(output_, result.log, description);
    tell(description, result, run);
  }

  /// The virtual robot knows no stops; a machine would run into them.
  static void tell_of_the_plate(const RobotDescription& robot, const TrajectorySamples& motion) {
    if (!robot.plate) return;
    const double farthest = motion.z.col(3).cwiseAbs().maxCoeff(), range = robot.plate_yaw_range();
    if (farthest > range * (1 + 1e-9))
      fmt::print(stderr,
                 "warning: the motion turns the tool to {:.4g} rad, but the plate allows {:.4g} rad to either "
                 "side\n",
                 farthest, range);
  }

  static Eigen::VectorXd matched(const ParameterTable& table, const Robot& robot) {
    const ParameterMatch match = match_parameters(table, robot.parameter_names(), robot.parameter_units());
    for (const std::string& warning : match.warnings) fmt::print("note: {}\n", warning);
    return match.value;
  }

  /// A resolution for drives that the robot does not have would be lost without a word.
  void check_encoders(const RobotDescription& robot) const {
    bool turns = false, slides = false;
    for (int j = 0; j < robot.drives(); ++j) (robot.kind_of_drive(j) == DriveKind::revolute ? turns : slides) = true;
    if (encoder_bits_ > 0 && !turns)
      throw Error("--encoder-bits is for revolute drives, and this robot has none", "", "give --encoder-step-m",
                  ExitCode::usage);
    if (encoder_step_m_ > 0 && !slides)
      throw Error("--encoder-step-m is for prismatic drives, and this robot has none", "", "give --encoder-bits",
                  ExitCode::usage);
  }

  void complete_options(const RobotDescription& robot, const ToolRun& run) {
    const auto n = static_cast<std::size_t>(robot.drives());
    check_encoders(robot);
    options_.seed = run.seed;
    options_.control_rate_hz = control_rate_hz_ > 0 ? control_rate_hz_ : options_.log_rate_hz;
    options_.controller.law = law_ == "computed-torque" ? ControlLaw::computed_torque
                              : law_ == "augmented-pd"  ? ControlLaw::augmented_pd
                                                        : ControlLaw::pd_feedforward;
    options_.controller.feed_forward = !no_feed_forward_;
    if (no_feed_forward_ && law_ != "pd-feedforward") {
      throw Error("--no-feed-forward goes with --controller pd-feedforward only", "", "", ExitCode::usage);
    }
    if (!options_.controller.kp.empty()) options_.controller.kp = tools::spread(options_.controller.kp, n, "--kp");
    if (!options_.controller.kd.empty()) options_.controller.kd = tools::spread(options_.controller.kd, n, "--kd");
    for (int j = 0; j < robot.drives(); ++j) {
      const bool turns = robot.kind_of_drive(j) == DriveKind::revolute;
      options_.sensors.encoder_step.push_back(
          turns ? (encoder_bits_ > 0 ? 2 * std::numbers::pi / std::exp2(encoder_bits_) : 0.0) : encoder_step_m_);
    }
    if (!encoder_noise_.empty())
      options_.sensors.encoder_noise = tools::spread(encoder_noise_, n, "--encoder-noise-rad");
    if (!torque_noise_.empty()) options_.sensors.torque_noise = tools::spread(torque_noise_, n, "--torque-noise-n-m");
    options_.validate(robot.drives());
  }

  void tell(const RobotDescription& robot, const SimulationResult& result, ToolRun& run) const {
    Summary& out = run.summary;
    fmt::print("{} samples, {:.4g} s\n", result.log.samples(),
               result.log.samples() > 1 ? result.log.t_s(result.log.samples() - 1) : 0.0);
    out.add("samples", result.log.samples());
    if (!options_.inverse) fmt::print("drive   rms error   largest error   largest torque\n");
    for (int j = 0; j < robot.drives(); ++j) {
      const bool turns = robot.kind_of_drive(j) == DriveKind::revolute;
      const char *length = turns ? "rad" : "m", *force = turns ? "N*m" : "N";
      if (!options_.inverse) {
        fmt::print("{:>5}   {:>9.3g}   {:>9.3g} {:<3}   {:>10.4g} {}\n", j + 1, result.rms_error(j),
                   result.largest_error(j), length, result.largest_torque(j), force);
        out.add(fmt::format("rms_error_drive{}", j + 1), result.rms_error(j), length);
        out.add(fmt::format("largest_error_drive{}", j + 1), result.largest_error(j), length);
      }
      out.add(fmt::format("largest_torque_drive{}", j + 1), result.largest_torque(j), force);
    }
    if (result.clipped > 0) {
      fmt::print(stderr, "warning: the torque met the drives' effort limits at {} control samples\n", result.clipped);
    }
    if (!options_.inverse) {
      out.add("clipped_samples", result.clipped);
      out.add("reversals", result.counts.reversals);
      out.add("stuck_time_s", result.counts.stuck_s, "s");
      out.add("integration_steps", result.counts.steps);
      out.add("work", result.work, "J");
      out.add("losses", result.losses, "J");
      out.add("energy_imbalance", result.energy_change - (result.work - result.losses), "J");
    }
    fmt::print("wrote {}\n", output_);
  }

  std::string robot_file_, parameter_file_, trajectory_file_, controller_parameter_file_, effects_file_, output_,
      law_ = "pd-feedforward";
  std::vector<std::string> effects_;
  std::vector<double> encoder_noise_, torque_noise_;
  double control_rate_hz_ = 0, encoder_step_m_ = 0;
  int encoder_bits_ = 0, repeats_ = 1;
  bool no_feed_forward_ = false, with_derivatives_ = false;
  SimulationOptions options_;
};

}  // namespace

int main(int argc, char** argv) {
  Simulate simulate;
  return tools::run_tool(argc, argv,
                         {"delta-simulate",
                          "The log of a virtual robot that follows a trajectory in closed loop: friction that sticks, "
                          "sampled control, encoders, "
                          "noise, and any effect of the catalogue.",
                          "delta-simulate robot.urdf --params params.csv --trajectory trajectory.csv --encoder-bits 19 "
                          "--torque-noise-n-m 0.1 \\\n  "
                          "  --effect " +
                              tools::example_effect() + " -o log.csv"},
                         [&](CLI::App& app, ToolRun& run) { simulate.add_to(app, run); });
}
