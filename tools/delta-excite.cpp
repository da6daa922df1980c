/// \file
/// delta-excite: the motion that shows every parameter, inside the limits of the machine.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "deltadyn/excitation/optimize.hpp"
#include "deltadyn/excitation/predicted_uncertainty.hpp"
#include "deltadyn/excitation/reversals.hpp"
#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/identification/log_processing.hpp"
#include "deltadyn/io/coefficient_file.hpp"
#include "deltadyn/io/output_file.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/io/trajectory_file.hpp"
#include "deltadyn/report/excitation_report.hpp"
#include "deltadyn/report/plot.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"
#include "deltadyn/runtime/plausibility.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/runtime/workspace.hpp"
#include "deltadyn/trajectory/motion_plan.hpp"

#include "processing_flags.hpp"
#include "tool_support.hpp"

namespace {

using namespace deltadyn;
using Eigen::VectorXd;
using tools::ToolRun;

constexpr int kScaleStates = 500;         // states for the torque scale of a robot without effort limits
constexpr double kNoiseOfScale = 0.005;   // torque noise, where none is given: share of the torque scale
constexpr double kValidationShare = 0.3;  // of the time, for the validation trajectory
// What follows the search, in units of the time that what precedes it took on this machine at this hour, measured with
// kUsualStates: run-in, run-out and final check of a segment; samples, a hundred thousand; the report, which gnuplot makes slow.
constexpr double kPlanShare = 0.25, kSamplesShare = 0.8, kReportShare = 0.5;
constexpr int kFewestEvaluations = 20;  // of a search that deserves the name
constexpr double kReport_s = 0.6;       // at least
constexpr int kUsualStates = 6000;
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
    const auto list = [&app](const char* flag, std::vector<double>& values, const std::string& text) {
      app.add_option(flag, values, text)->delimiter(',')->type_name("LIST");
    };
    const std::string count = ", one or one a drive separated by commas [the robot file's]";
    app.add_option("robot", robot_file_, "robot file (URDF)")->required()->type_name("ROBOT");
    app.add_option("-o,--output", output_, "trajectory t_s,x_m,..,xd_m_s,..,q1_rad,..,qd1_rad_s,..,qdd1_rad_s2,.. (CSV)")
        ->required()
        ->type_name("FILE");
    app.add_option("--coefficients", coefficients_, "coefficients of the Fourier series (CSV)")->type_name("FILE");
    app.add_option("--validation", validation_, "a second trajectory from other starts, to check the model on (CSV)")
        ->type_name("FILE");
    app.add_option("--report", report_file_, "report (HTML)")->type_name("FILE");

    app.add_option("--workspace", shape_, "shape that the plate's centre stays in [a ball that the robot reaches]")
        ->check(CLI::IsMember({"half-ball", "ball", "cylinder", "cone", "box"}));
    list("--workspace-center-m", centre_, "its centre x,y,z; half-ball: of the flat side, which is up [m]");
    app.add_option("--workspace-radius-m", radius_, "radius; cone: at its lower end [m]");
    app.add_option("--workspace-top-radius-m", top_radius_, "cone: radius at its upper end [m]");
    app.add_option("--workspace-height-m", height_, "height of cylinder and cone, centre in the middle [m]");
    list("--workspace-size-m", size_, "box: edges along x,y,z [m]");

    app.add_option("--drive-range-rad", range_rad_, "position limits lo,hi or lo,hi;lo,hi;.. [rad] [the robot file's]");
    app.add_option("--drive-range-m", range_m_, "the same of prismatic drives [m]");
    list("--drive-velocity-rad-s", velocity_rad_, "velocity limits [rad/s]" + count);
    list("--drive-velocity-m-s", velocity_m_, "the same of prismatic drives [m/s]");
    list("--drive-acceleration-rad-s2", acceleration_rad_, "acceleration limits [rad/s^2]" + count);
    list("--drive-acceleration-m-s2", acceleration_m_, "the same of prismatic drives [m/s^2]");
    list("--drive-torque-n-m", torque_, "torque limits, with --params [N m]" + count);
    list("--drive-force-n", force_, "the same of prismatic drives [N]");
    app.add_option("--params", params_file_, "known model name,value,unit (CSV): limits the torque, and gives relative figures")
        ->type_name("FILE");
    list("--platform-velocity-m-s", plate_velocity_, "of the plate, each of x, y, z: one or three [m/s] [not limited]");
    list("--platform-acceleration-m-s2", plate_acceleration_, "of the plate, each of x, y, z [m/s^2] [not limited]");
    app.add_option("--yaw-velocity-rad-s", yaw_velocity_, "of the fourth coordinate [rad/s] [not limited]");
    app.add_option("--yaw-acceleration-rad-s2", yaw_acceleration_, "of the fourth coordinate [rad/s^2] [not limited]");
    app.add_option("--yaw-range-rad", yaw_range_, "largest angle to either side of the fourth coordinate [rad]");

    app.add_option("--base-frequency-hz", frequency_, "range lower,upper of the base frequency [Hz]")
        ->delimiter(',')
        ->expected(1, 2)
        ->capture_default_str();
    app.add_option("--harmonics", options_.harmonics, "harmonics of the Fourier series (8)")->capture_default_str();
    list("--torque-scale", torque_scale_, "weights of (9): largest torque a drive [N m | N] [effort of the robot file]");
    app.add_option("--criterion", criterion_, "what is made large (9)")
        ->check(CLI::IsMember({"logdet", "cond", "det", "trace", "min-eigenvalue"}))
        ->capture_default_str();
    app.add_option("--velocity-weight", options_.velocity_weight, "w of (9): weight of the drive velocities beside the criterion")
        ->capture_default_str();
    app.add_option("--segments", segments_, "motions one after the other, each as good as possible beside the others")
        ->capture_default_str();
    list("--segment-speeds", options_.speeds, "speed of each segment as a share of the velocity limits, e.g. 0.3,1 [1]");
    app.add_flag("--segment-files", segment_files_, "each segment in a file of its own, too: OUTPUT_1.csv, OUTPUT_2.csv, ..");
    app.add_option("--away-from-reversals", options_.least_away,
                   "share of the time that every drive is away from velocity reversals, at least, 0: no matter [1]")
        ->capture_default_str();
    app.add_option("--cutoff-hz", cutoff_hz_, "cut-off of the identification, which sets what it leaves out near a reversal [Hz]")
        ->capture_default_str();
    app.add_option("--torque-margin", torque_margin_,
                   "share of the torque limits left for a model that is off, 0..0.9 [the model's uncertainty and 5 %]");
    app.add_option("--duration-s", duration_s_, "of the periodic part of each segment, at least; whole periods [s]")
        ->capture_default_str();
    app.add_option("--rate-hz", options_.rate_hz, "sample rate of the controller [Hz]")->capture_default_str();
    app.add_flag("--periodic", periodic_, "only the periodic part, no run-in and run-out");
    app.add_option("--starts", options_.starts, "starts of the search, 0: as many as the time allows")->capture_default_str();
    app.add_option("--time-limit-s", time_limit_s_, "of the whole tool; the best motion until then is written [s]")
        ->capture_default_str();
    app.add_option("--bound-states", bound_states_, "admissible states for the upper bound of the efficiency")
        ->check(CLI::Range(500, 200000))
        ->capture_default_str();
    list("--torque-noise", noise_,
         "standard deviation of the torque noise a drive, for the report [N m | N] [0.5 % of the scale]");
    app.add_flag("--individual-limbs", individual_limbs_, "every limb has parameters of its own");
    app.add_flag("--without-tool", without_tool_, "leave out the tool's ten parameters (delta4)");
    app.add_option("--rotor-inertia", rotor_inertia_, "drives with a rotor inertia of their own, e.g. 4")->delimiter(',');
    offset_flag_ = app.add_flag("--offset,!--no-offset", offset_, "a torque offset for every drive [on for an axis, else off]");
    run.on(app, [this, &run] { return execute(run); });
  }

 private:
  /// What belongs to one trajectory file.
  struct Written {
    Excitation excitation;
    std::vector<PlanSegment> segments;
    MotionPlan plan;
    LimitCheck check;
    TrajectorySamples samples;
  };

  ExitCode execute(ToolRun& run) {
    const auto start = std::chrono::steady_clock::now();
    const auto seconds = [start] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
    std::vector<std::string> outputs = {output_, coefficients_, validation_, report_file_};
    const std::vector<std::string> own_files = segment_file_names();
    outputs.insert(outputs.end(), own_files.begin(), own_files.end());
    run.check_files(outputs, {robot_file_, params_file_});
    if (!report_file_.empty() && !gnuplot_available())
      throw Error("the report needs gnuplot", "", "install gnuplot-nox, or leave out --report", ExitCode::usage);
    options_.seed = run.seed;
    const RobotDescription description = read_robot_file(robot_file_);
    const auto robot = make_robot(description, parameter_options(description));
    set_options();
    const NominalParameters nominal = nominal_parameters(*robot, PartShapes(description));
    NominalParameters model = nominal;
    if (!params_file_.empty()) model = known_model(*robot);
    const VectorXd& parameters = model.value;
    MotionLimits limits = motion_limits(*robot, parameters);
    if (!params_file_.empty()) keep_torque_margin(*robot, model, limits);
    const BaseParameters base = find_base_parameters(*robot);
    const VectorXd scale = torque_scale(*robot, nominal.value);
    if (!params_file_.empty()) tell_scale_below_friction(*robot, parameters, scale);
    const DesignSpace space = make_design_space(*robot, limits, base.independent, scale, bound_states_, run.seed);
    const DesignBound bound = design_bound(space);

    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
    options_.stop = &interrupted;
    options_.elapsed_s = seconds();
    // Planned for the time that was given, ended in time for what follows: the same seed then gives the same file.
    options_.planned_time_s = validation_.empty() ? time_limit_s_ : (1 - kValidationShare) * time_limit_s_;
    const Following following = time_after_search(options_.elapsed_s);
    const double kept_for_report = validation_.empty() ? following.report_s : 0.0;
    options_.time_limit_s = std::max(options_.elapsed_s, options_.planned_time_s - following.plan_s - kept_for_report);
    tools::ProgressBar bar("looking for the best motion");
    options_.progress = [&bar](double share) { bar.update(share); };
    const Written main = make(*robot, space, limits, bound, options_);
    write_trajectory(output_, main.samples, description);
    for (std::size_t k = 0; k < own_files.size(); ++k) {
      const MotionPlan plan = make_plan(*robot, {main.segments[k]}, options_.rate_hz, periodic_);
      write_trajectory(own_files[k], sample_plan(*robot, plan, options_.rate_hz), description);
    }
    if (!coefficients_.empty()) {
      std::vector<FourierSeries> series;
      for (const Excitation::Segment& segment : main.excitation.segments) series.push_back(segment.series);
      write_coefficients(coefficients_, series, description);
    }
    std::optional<Written> second;
    if (!validation_.empty()) {
      ExcitationOptions other = options_;
      other.seed = run.seed ^ kValidationSeed;
      // As the first one planned for its share of the time, whatever that one took.
      other.elapsed_s = std::max(seconds(), (1 - kValidationShare) * time_limit_s_);
      other.planned_time_s = kValidationShare * time_limit_s_;
      other.time_limit_s = std::max(other.elapsed_s, time_limit_s_ - following.plan_s - following.report_s);
      second = make(*robot, space, limits, bound, other);
      write_trajectory(validation_, second->samples, description);
    }
    VectorXd noise = kNoiseOfScale * scale;
    if (!noise_.empty()) noise = spread(noise_, description.drives(), "--torque-noise");
    ExcitationReportInput input{*robot, base, main.excitation, main.segments, main.plan, main.check, main.samples, bound};
    input.torque_noise = noise;
    input.predicted_std = predicted_std(*robot, base.independent, main.samples, noise);
    input.base_values = base.B * parameters;
    const VectorXd spread_of_base = (base.B.cwiseAbs2() * nominal.std.cwiseAbs2()).cwiseSqrt();
    input.base_scale = input.base_values.cwiseAbs().cwiseMax(spread_of_base);
    input.values_are_nominal = params_file_.empty();
    if (second) input.validation = &second->samples;
    if (options_.reversal_reach_s > 0) {
      input.away_from_reversals = away_from_reversals(*robot, main.segments);
      input.least_away = options_.least_away;
      input.reversal_cutoff_hz = cutoff_hz_;
    }
    if (!report_file_.empty()) {
      ReportContext context;
      context.robot_file = robot_file_;
      context.parameter_file = params_file_;
      context.command_line = command_line_;
      write_file(report_file_, excitation_report(input, context));
    }
    return tell(input, second ? &*second : nullptr, seconds(), run.summary);
  }

  /// Time to keep for what follows a search.
  struct Following {
    double plan_s = 0, report_s = 0;
  };
  Following time_after_search(double preparation_s) const {
    const double unit = preparation_s * std::min(1.0, static_cast<double>(kUsualStates) / bound_states_);
    const auto segments = static_cast<double>(options_.speeds.size());
    Following time;
    time.plan_s = unit * segments * (kPlanShare + kSamplesShare * 1e-5 * duration_s_ * options_.rate_hz);
    if (!params_file_.empty()) time.plan_s *= 2;  // torques are looked at, too
    if (!report_file_.empty()) time.report_s = (0.5 + 0.5 * segments) * std::max(kReport_s, kReportShare * unit);
    return time;
  }

  Written make(const Robot& robot, const DesignSpace& space, const MotionLimits& limits, const DesignBound& bound,
               const ExcitationOptions& options) const {
    Written out;
    out.excitation = optimize_excitation(space, limits, bound, options);
    for (const Excitation::Segment& segment : out.excitation.segments) {
      const int periods = static_cast<int>(std::ceil(duration_s_ / segment.series.period_s() - 1e-9));
      out.segments.push_back({segment.series, segment.limits, periods});
    }
    out.plan = make_plan(robot, out.segments, options.rate_hz, periodic_);
    out.check = check_plan(robot, out.segments, out.plan);
    if (out.check.margin() < 0) {
      const LimitUse& use = out.check.tightest();
      throw Error(fmt::format("the motion breaks the limit '{}' at {:.4f} s: {:.8g} {}", use.limit.name, use.time_s, use.value,
                              use.limit.unit),
                  "", "give more time, or another --seed", ExitCode::no_convergence);
    }
    if (!(out.excitation.d_efficiency > 0))
      throw Error("the motion found keeps the limits, but does not show all base parameters", "--time-limit-s", "give more time",
                  ExitCode::no_convergence);
    out.samples = sample_plan(robot, out.plan, options.rate_hz);
    return out;
  }

  void set_options() {
    options_.criterion = criterion_of(criterion_);
    options_.lowest_hz = frequency_.front();
    options_.highest_hz = frequency_.back();
    if (options_.speeds.empty()) options_.speeds = {1.0};
    if (segments_ < 1) throw Error("--segments is below 1", "", "give 1 or more", ExitCode::usage);
    if (options_.speeds.size() == 1) options_.speeds.resize(static_cast<std::size_t>(segments_), options_.speeds.front());
    if (segments_ > 1 && options_.speeds.size() != static_cast<std::size_t>(segments_))
      throw Error(fmt::format("{} speeds for {} segments", options_.speeds.size(), segments_), "--segment-speeds",
                  "give one speed a segment", ExitCode::usage);
    options_.time_limit_s = time_limit_s_;
    options_.validate();
    if (segment_files_ && segments_ < 2 && options_.speeds.size() < 2)
      throw Error("--segment-files with one segment", "", "give --segments 2 --segment-speeds 0.3,1, or leave it out",
                  ExitCode::usage);
    set_reversals();
    if (!(duration_s_ > 0) || !(duration_s_ <= 36000))
      throw Error("--duration-s is out of range", "", "give 0 to 36000 s", ExitCode::usage);
    if (options_.lowest_hz * duration_s_ < 1 - 1e-9)
      throw Error(fmt::format("a base frequency of {:.4g} Hz is too low for {:.4g} s: its period lasts {:.4g} s",
                              options_.lowest_hz, duration_s_, 1 / options_.lowest_hz),
                  "--base-frequency-hz",
                  fmt::format("give a lower end of {:.4g} Hz or more, or a longer --duration-s", 1 / duration_s_),
                  ExitCode::usage);
    if (periodic_ && options_.speeds.size() > 1)
      throw Error("--periodic holds one segment", "", "leave out --periodic or --segments", ExitCode::usage);
  }

  /// What an identification at this cut-off leaves out on either side of a reversal.
  void set_reversals() {
    const ProcessingOptions usual;
    const double low_pass_hz = usual.torque_cutoff_ratio * cutoff_hz_;
    if (!(cutoff_hz_ > 0) || !(low_pass_hz < 0.5 * options_.rate_hz))
      throw Error(fmt::format("a cut-off of {} Hz is out of range", cutoff_hz_), "--cutoff-hz",
                  fmt::format("give 1 to {:.4g} Hz", 0.25 * options_.rate_hz), ExitCode::usage);
    options_.reversal_reach_s = options_.least_away > 0 ? reversal_reach_s(low_pass_hz, options_.rate_hz) : 0.0;
  }

  /// Drives x segments, over the periodic part of each.
  [[nodiscard]] Eigen::MatrixXd away_from_reversals(const Robot& robot, const std::vector<PlanSegment>& segments) const {
    Eigen::MatrixXd shares(robot.drives(), static_cast<Eigen::Index>(segments.size()));
    for (std::size_t k = 0; k < segments.size(); ++k) {
      const MotionPlan plan = make_plan(robot, {segments[k]}, options_.rate_hz, true);
      shares.col(static_cast<Eigen::Index>(k)) = share_away_from_reversals(
          robot, sample_plan(robot, plan, options_.rate_hz), options_.reversal_reach_s, ProcessingOptions{}.reversal_floor);
    }
    return shares;
  }

  /// OUTPUT_1.csv, OUTPUT_2.csv, .. beside the output, if they are asked for.
  [[nodiscard]] std::vector<std::string> segment_file_names() const {
    std::vector<std::string> names;
    if (!segment_files_) return names;
    const std::filesystem::path path(output_);
    const std::size_t count = std::max(static_cast<std::size_t>(std::max(segments_, 1)), options_.speeds.size());
    for (std::size_t k = 1; k <= count; ++k)
      names.push_back((path.parent_path() / fmt::format("{}_{}{}", path.stem().string(), k, path.extension().string())).string());
    return names;
  }

  /// Values of --params; a value whose standard deviation the file does not give is as uncertain as a prior of the fit.
  [[nodiscard]] NominalParameters known_model(const Robot& robot) const {
    const ParameterMatch match =
        match_parameters(read_parameters(params_file_, robot.description()), robot.parameter_names(), robot.parameter_units());
    NominalParameters model{match.value, match.std};
    const VectorXd usual = ConsistentFitOptions{}.prior_relative_std * match.value.cwiseAbs();
    model.std = model.std.array().isFinite().select(model.std, usual);
    return model;
  }

  /// Share of the torque that the model's uncertainty may make of a drive's torque, all parameters off the same way, as those of a
  /// prior that is too light are.
  [[nodiscard]] static double model_uncertainty(const Robot& robot, const NominalParameters& model) {
    WorkspaceSampler sampler(robot);
    VectorXd q, qd, qdd;
    Eigen::MatrixXd Y(robot.drives(), robot.parameters());
    VectorXd off = VectorXd::Zero(robot.drives()), all = off;
    for (int k = 0; k < kScaleStates; ++k) {
      sampler.next(q, qd, qdd);
      if (robot.regressor(q, qd, qdd, Y) != Status::ok) continue;
      off += Y.cwiseAbs() * model.std;
      all += Y.cwiseAbs() * model.value.cwiseAbs();
    }
    return off.cwiseQuotient(all.cwiseMax(1e-300)).maxCoeff();
  }

  /// Takes the margin off the torque limits, and refuses limits that friction alone exceeds.
  void keep_torque_margin(const Robot& robot, const NominalParameters& model, MotionLimits& limits) const {
    constexpr double kForTheLoop = 0.05;  // what the controller adds to the model's torque
    constexpr double kLargest = 0.5;      // a model that is further off does not limit a torque at all
    if (torque_margin_ && !(*torque_margin_ >= 0 && *torque_margin_ < 0.9))
      throw Error("--torque-margin is out of range", "", "give 0 to 0.9, the share of the torque limits to keep free",
                  ExitCode::usage);
    const double margin = torque_margin_.value_or(std::min(kLargest, model_uncertainty(robot, model) + kForTheLoop));
    bool limited = false;
    for (int i = 0; i < robot.drives(); ++i) {
      if (!std::isfinite(limits.tau(i))) continue;
      limited = true;
      const double friction = coulomb_of(robot, model.value, i);
      const char* unit = tools::torque_unit(robot.description(), i);
      if (friction >= (1 - margin) * limits.tau(i))
        throw Error(
            fmt::format("the model's Coulomb friction of drive {} is {:.4g} {}, of {:.4g} {} that the drive may give ({:.4g} {} "
                        "less a margin of {:.0f} %): nothing may move",
                        i + 1, friction, unit, (1 - margin) * limits.tau(i), unit, limits.tau(i), unit, 100 * margin),
            params_file_,
            "check unit and scale of the friction in the model, and of the torque limits; --torque-margin 0 "
            "keeps nothing free");
    }
    if (!limited) return;
    limits.tau *= 1 - margin;
    fmt::print("torque limits planned with a margin of {:.0f} % for a model that is off{}\n", 100 * margin,
               torque_margin_ ? "" : " (its uncertainty and 5 %; --torque-margin)");
  }

  [[nodiscard]] static double coulomb_of(const Robot& robot, const VectorXd& parameters, int drive) {
    const auto& names = robot.parameter_names();
    const auto at = std::find(names.begin(), names.end(), fmt::format("drive{}.coulomb", drive + 1));
    return at == names.end() ? 0.0 : std::abs(parameters(at - names.begin()));
  }

  static void tell_scale_below_friction(const Robot& robot, const VectorXd& parameters, const VectorXd& scale) {
    for (int i = 0; i < robot.drives(); ++i) {
      const double friction = coulomb_of(robot, parameters, i);
      const char* unit = tools::torque_unit(robot.description(), i);
      if (friction > scale(i))
        fmt::print(
            "note: the torque scale of drive {} is {:.4g} {}, less than its Coulomb friction in the model, {:.4g} {}: check "
            "the unit of --torque-scale or of the model\n",
            i + 1, scale(i), unit, friction, unit);
    }
  }

  ParameterOptions parameter_options(const RobotDescription& robot) const {
    ParameterOptions options;
    options.individual_limbs = individual_limbs_;
    options.tool = !without_tool_;
    options.rotor_inertia = rotor_inertia_;
    options.offset = offset_flag_->count() > 0 ? offset_ : robot.type == Axis::kName;
    return options;
  }

  static VectorXd spread(const std::vector<double>& values, int count, const std::string& flag) {
    const std::vector<double> all = tools::spread(values, static_cast<std::size_t>(count), flag);
    return Eigen::Map<const VectorXd>(all.data(), count);
  }

  MotionLimits motion_limits(const Robot& robot, const VectorXd& parameters) const {
    const RobotDescription& description = robot.description();
    const int n = description.drives();
    MotionLimits limits(description);
    const bool linear = description.drive_kind == DriveKind::prismatic;
    const auto wrong_unit = [&](bool given, const char* flag) {
      if (given)
        throw Error(fmt::format("{} is not the unit of the drives of this robot", flag), "",
                    linear ? "use the flags in metres" : "use the flags in radians", ExitCode::usage);
    };
    wrong_unit(!(linear ? range_rad_ : range_m_).empty(), linear ? "--drive-range-rad" : "--drive-range-m");
    wrong_unit(!(linear ? velocity_rad_ : velocity_m_).empty(), linear ? "--drive-velocity-rad-s" : "--drive-velocity-m-s");
    wrong_unit(!(linear ? acceleration_rad_ : acceleration_m_).empty(),
               linear ? "--drive-acceleration-rad-s2" : "--drive-acceleration-m-s2");
    wrong_unit(!(linear ? torque_ : force_).empty(), linear ? "--drive-torque-n-m" : "--drive-force-n");
    if (const std::string& range = linear ? range_m_ : range_rad_; !range.empty()) {
      const auto ranges =
          tools::spread_ranges(range, static_cast<std::size_t>(n), linear ? "--drive-range-m" : "--drive-range-rad");
      for (int i = 0; i < n; ++i) std::tie(limits.q_lower(i), limits.q_upper(i)) = ranges[static_cast<std::size_t>(i)];
    }
    const auto set = [&](const std::vector<double>& values, VectorXd& to, const char* flag) {
      if (!values.empty()) to = spread(values, n, flag);
    };
    set(linear ? velocity_m_ : velocity_rad_, limits.qd, linear ? "--drive-velocity-m-s" : "--drive-velocity-rad-s");
    set(linear ? acceleration_m_ : acceleration_rad_, limits.qdd,
        linear ? "--drive-acceleration-m-s2" : "--drive-acceleration-rad-s2");
    const auto& effort = linear ? force_ : torque_;
    set(effort, limits.tau, linear ? "--drive-force-n" : "--drive-torque-n-m");
    if (!effort.empty() && params_file_.empty())
      throw Error("a torque limit needs a model of the robot", linear ? "--drive-force-n" : "--drive-torque-n-m",
                  "give --params, or leave the flag out", ExitCode::usage);
    if (!params_file_.empty()) limits.parameters = parameters;
    set_task_limits(robot, limits);
    limits.validate(description);
    tell_beyond_file(description, limits);
    return limits;
  }

  /// The robot file holds what the machine can do; more than that is said, and far more refused.
  static void tell_beyond_file(const RobotDescription& description, const MotionLimits& limits) {
    for (int i = 0; i < description.drives(); ++i) {
      DriveLimits asked;
      asked.lower = limits.q_lower(i);
      asked.upper = limits.q_upper(i);
      asked.velocity = limits.qd(i);
      asked.acceleration = limits.qdd(i);
      asked.effort = limits.tau(i);
      const std::string beyond = plausibility::compare_limits(description, i, asked, "limits");
      if (!beyond.empty()) fmt::print("note: {}\n", beyond);
    }
  }

  void set_task_limits(const Robot& robot, MotionLimits& limits) const {
    const RobotDescription& description = robot.description();
    const int n = description.drives();
    const bool plate = !description.parts.empty();
    const auto refuse = [](bool given, const char* flag, const char* why) {
      if (given) throw Error(fmt::format("{} has no meaning: {}", flag, why), "", "leave it out", ExitCode::usage);
    };
    refuse(!plate && (!shape_.empty() || !centre_.empty() || !plate_velocity_.empty() || !plate_acceleration_.empty()),
           "a workspace or platform flag", "an axis has no plate");
    refuse(n < 4 && (yaw_velocity_ || yaw_acceleration_ || yaw_range_), "a yaw flag", "the robot has no fourth coordinate");
    if (yaw_velocity_) limits.zd(3) = *yaw_velocity_;
    if (yaw_acceleration_) limits.zdd(3) = *yaw_acceleration_;
    if (yaw_range_) {
      limits.z_lower(3) = -*yaw_range_;
      limits.z_upper(3) = *yaw_range_;
    }
    if (!plate) return;
    if (!plate_velocity_.empty()) limits.zd.head<3>() = spread(plate_velocity_, 3, "--platform-velocity-m-s");
    if (!plate_acceleration_.empty()) limits.zdd.head<3>() = spread(plate_acceleration_, 3, "--platform-acceleration-m-s2");
    limits.region = region(robot);
  }

  Region region(const Robot& robot) const {
    const WorkspaceBall ball = WorkspaceSampler(robot).ball();
    Region region;
    if (shape_.empty()) {
      const bool other = radius_ || top_radius_ || height_ || !size_.empty() || !centre_.empty();
      if (other)
        throw Error("lengths of a workspace without its shape", "--workspace", "give half-ball, ball, cylinder, cone or box",
                    ExitCode::usage);
      region.shape = RegionShape::ball;
      region.centre = ball.centre;
      region.radius = ball.radius;
      fmt::print("note: no --workspace; a {} is used\n", region.text());
      return region;
    }
    region.shape = region_shape(shape_);
    if (centre_.empty())
      throw Error("the workspace has no centre", "--workspace-center-m",
                  fmt::format("give x,y,z; around ({:.3f}, {:.3f}, {:.3f}) m the robot moves well", ball.centre.x(),
                              ball.centre.y(), ball.centre.z()),
                  ExitCode::usage);
    region.centre = spread(centre_, 3, "--workspace-center-m");
    region.radius = radius_.value_or(0);
    region.top_radius = top_radius_.value_or(0);
    region.height = height_.value_or(0);
    if (!size_.empty()) region.size = spread(size_, 3, "--workspace-size-m");
    region.validate();
    return region;
  }

  VectorXd torque_scale(const Robot& robot, const VectorXd& nominal) const {
    const int n = robot.drives();
    if (!torque_scale_.empty()) return spread(torque_scale_, n, "--torque-scale");
    VectorXd scale(n);
    for (int i = 0; i < n; ++i) scale(i) = robot.description().limits[static_cast<std::size_t>(i)].effort;
    if (scale.allFinite()) return scale;
    WorkspaceSampler sampler(robot);
    VectorXd q, qd, qdd, tau(n), squares = VectorXd::Zero(n);
    for (int k = 0; k < kScaleStates; ++k) {
      sampler.next(q, qd, qdd);
      if (robot.inverse_dynamics(q, qd, qdd, nominal, tau) == Status::ok) squares += tau.cwiseAbs2();
    }
    scale = 2 * (squares / kScaleStates).cwiseSqrt().cwiseMax(1e-6);
    fmt::print("note: no --torque-scale and no effort in the robot file; twice the usual torque of nominal parameters is used\n");
    return scale;
  }

  /// Shares away from reversals of each segment, by drives.
  void tell_reversals(const Eigen::MatrixXd& away, const std::string& of, Summary& out) const {
    for (Eigen::Index k = 0; k < away.cols(); ++k) {
      std::vector<std::string> shares;
      for (Eigen::Index i = 0; i < away.rows(); ++i) {
        shares.push_back(fmt::format("{:.0f}", 100 * away(i, k)));
        out.add(fmt::format("away_from_reversals_{}segment{}_drive{}", of.empty() ? "" : of + "_", k + 1, i + 1), away(i, k));
      }
      fmt::print("{}{}segment {}: {} % of the rows of drives 1..{} away from velocity reversals, at a cut-off of {:.3g} Hz\n", of,
                 of.empty() ? "" : ", ", k + 1, fmt::join(shares, ", "), shares.size(), cutoff_hz_);
    }
  }

  ExitCode tell(const ExcitationReportInput& input, const Written* validation, double total_s, Summary& out) const {
    const Excitation& e = input.excitation;
    const LimitUse& tight = input.check.tightest();
    const Assessment assessment = assess_excitation(input);
    fmt::print("{}\n", e.brief_report());
    fmt::print("{} base parameters of {} columns, {} samples in {:.3f} s\n", input.base.count(), input.robot.parameters(),
               input.samples.samples(), input.plan.duration_s);
    for (std::size_t k = 0; k < e.segments.size(); ++k) {
      const FourierSeries& series = e.segments[k].series;
      fmt::print("segment {}: base frequency {:.5g} Hz, {} periods of {:.4g} s\n", k + 1, series.base_frequency_hz,
                 input.segments[k].periods, series.period_s());
      out.add(fmt::format("base_frequency_segment{}", k + 1), series.base_frequency_hz, "Hz");
      out.add(fmt::format("periods_segment{}", k + 1), input.segments[k].periods);
    }
    std::vector<std::string> binding;
    for (const LimitUse& use : input.check.uses)
      if (use.load > 0.99) binding.push_back(use.limit.name);
    fmt::print("limits used to 99 % or more: {}\n", binding.empty() ? "none" : fmt::format("{}", fmt::join(binding, ", ")));
    fmt::print("margin {:.3g} of the tightest limit ({}), between the samples, too\n", input.check.margin(), tight.limit.name);
    fmt::print("first feasible motion after {:.2f} s\n", e.first_feasible_time_s);
    const bool at_highest = std::any_of(e.segments.begin(), e.segments.end(), [this](const Excitation::Segment& segment) {
      return segment.series.base_frequency_hz > 0.99 * options_.highest_hz;
    });
    if (at_highest && options_.highest_hz > options_.lowest_hz)
      fmt::print("note: the base frequency is at its upper end; a wider --base-frequency-hz or more --harmonics may show more\n");
    for (std::size_t k = 0; k < e.segments.size(); ++k) {
      if (e.segments[k].evaluations < kFewestEvaluations)
        fmt::print(
            "note: the time was over before segment {} could be made better; it keeps the limits, but shows little. Give more "
            "--time-limit-s\n",
            k + 1);
    }
    tell_reversals(input.away_from_reversals, "", out);
    if (validation != nullptr && options_.reversal_reach_s > 0)
      tell_reversals(away_from_reversals(input.robot, validation->segments), "validation", out);
    out.add("d_efficiency", e.d_efficiency);
    out.add("constraint_margin", input.check.margin());
    out.add("tightest_limit", tight.limit.name);
    out.add("binding_limits", fmt::format("{}", fmt::join(binding, "; ")));
    out.add("log_det", e.log_det_physical);
    out.add("condition_number", e.condition_number);
    out.add("criterion", criterion_);
    out.add("criterion_value", e.value);
    out.add("base_parameters", input.base.count());
    out.add("columns", input.robot.parameters());
    out.add("samples", input.samples.samples());
    out.add("duration_s", input.plan.duration_s, "s");
    out.add("bound_gap", input.bound.gap(input.base.count()));
    out.add("bound_support", input.bound.support);
    out.add("first_feasible_time_s", e.first_feasible_time_s, "s");
    out.add("first_feasible_efficiency", e.first_feasible_efficiency);
    out.add("total_time_s", total_s, "s");
    out.add("evaluations", e.evaluations);
    out.add("starts", e.starts);
    out.add("finished_starts", e.finished_starts);
    out.add("stopped", e.interrupted ? "interrupted" : (e.out_of_time ? "time" : "completed"));
    if (validation != nullptr) out.add("validation_d_efficiency", validation->excitation.d_efficiency);
    out.add("verdict", tools::verdict_word(assessment.verdict));
    std::string written = output_;
    for (const std::string& file : segment_file_names()) written += ", " + file;
    for (const std::string& file : {coefficients_, validation_, report_file_}) written += file.empty() ? "" : ", " + file;
    fmt::print("wrote {}\n", written);
    tools::print_assessment(assessment);
    return ExitCode::done;
  }

  std::string command_line_, robot_file_, output_, coefficients_, validation_, report_file_, params_file_;
  std::string shape_, range_rad_, range_m_, criterion_ = "logdet";
  std::vector<double> centre_, size_, velocity_rad_, velocity_m_, acceleration_rad_, acceleration_m_, torque_, force_;
  std::vector<double> plate_velocity_, plate_acceleration_, torque_scale_, noise_, frequency_ = {0.1, 1.0};
  std::optional<double> radius_, top_radius_, height_, yaw_velocity_, yaw_acceleration_, yaw_range_;
  double duration_s_ = 10, time_limit_s_ = 60, cutoff_hz_ = 40;
  std::optional<double> torque_margin_;
  int segments_ = 1, bound_states_ = kUsualStates;
  bool periodic_ = false, segment_files_ = false, individual_limbs_ = false, without_tool_ = false, offset_ = false;
  CLI::Option* offset_flag_ = nullptr;
  std::vector<int> rotor_inertia_;
  ExcitationOptions options_ = [] {
    ExcitationOptions options;
    options.speeds.clear();
    options.least_away = 0.45;  // at a cut-off of 30 Hz a third is then still left, from which on validation has no reservations
    return options;
  }();
};

}  // namespace

int main(int argc, char** argv) {
  Excite excite(argc, argv);
  return tools::run_tool(
      argc, argv,
      {"delta-excite",
       "Find the motion that shows every dynamic parameter of a Delta-like robot as well as possible inside the limits of the "
       "machine. Ctrl-C ends the search with the best motion so far.",
       "delta-excite robot.urdf -o trajectory.csv --workspace half-ball --workspace-center-m 0,0,-0.80 \\\n"
       "      --workspace-radius-m 0.35 --platform-velocity-m-s 4 --platform-acceleration-m-s2 50 --torque-scale 60,60,60,4 \\\n"
       "      --coefficients coefficients.csv --validation validation.csv --report excitation.html"},
      [&](CLI::App& app, ToolRun& run) { excite.add_to(app, run); });
}
