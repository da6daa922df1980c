/// \file
/// delta-model: robot files from a few lengths, what they can do, and nominal parameters for them.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/io/output_file.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/report/plot.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"
#include "deltadyn/runtime/reach.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/runtime/workspace.hpp"

#include "tool_support.hpp"

namespace {

using namespace deltadyn;
using tools::ToolRun;

constexpr double kPi = std::numbers::pi;

[[noreturn]] void refuse_usage(const std::string& what, const std::string& mend) {
  throw Error(what, "", mend, ExitCode::usage);
}

Eigen::Vector3d vector_of(const std::vector<double>& values, const std::string& flag) {
  if (values.size() != 3) refuse_usage(fmt::format("{} has {} numbers", flag, values.size()), "give three, separated by commas");
  return {values[0], values[1], values[2]};
}

Eigen::Vector3d direction_of(const std::vector<double>& values, const std::string& flag) {
  const Eigen::Vector3d v = vector_of(values, flag);
  if (!(v.norm() > 1e-9 && v.allFinite())) refuse_usage(flag + " is no direction", "give a vector that is not zero");
  return v.normalized();
}

// --- create -----------------------------------------------------------------------------------

class Create {
 public:
  void add_to(CLI::App& app, ToolRun& run) {
    command_ = app.add_subcommand("create", "Make a robot file (URDF with URDF+ loops) from a few lengths.");
    CLI::App& c = *command_;
    tools::set_example(c,
                       "delta-model create delta4 --base-radius 0.2 --platform-radius 0.05 --upper-arm 0.525 --strut 1.106 \\\n"
                       "      --strut-spacing 0.1 --drive-velocity-rad-s 6,6,6,48 -o robot.urdf\n"
                       "  delta-model create linear-delta3 --base-radius 0.3 --platform-radius 0.06 --strut 0.8 --drive-range-m "
                       "0,0.9 -o l.urdf\n"
                       "  delta-model create axis --drive-kind prismatic --axis-direction 1,0,0 -o axis.urdf");
    c.add_option("type", type_, "delta3, linear-delta3, delta4 or axis")->required()->type_name("TYPE");
    c.add_option("-o,--output", output_, "robot file to write [standard output]")->type_name("FILE");
    c.add_option("--name", name_, "name of the robot [its type]");
    flag("--base-radius", base_radius_, "drive i at this distance from z, at azimuth 0, 120, 240 deg [m]",
         "delta3 linear-delta3 delta4");
    flag("--platform-radius", platform_radius_, "attachments of the limbs from the plate's centre [m]",
         "delta3 linear-delta3 delta4");
    flag("--upper-arm", upper_arm_, "drive axis to elbow [m]", "delta3 delta4");
    flag("--strut", strut_, "strut, ball centre to ball centre [m]", "delta3 linear-delta3 delta4");
    flag("--strut-spacing", spacing_, "distance of the two struts of a limb [m], default 0.1", "delta3 linear-delta3 delta4");
    flag("--elbow", elbow_, "outwards (default) or inwards; of carriages: above (default) or below",
         "delta3 linear-delta3 delta4");
    list("--telescope-base-m", telescope_base_, "upper joint of the telescope bar from the base origin x,y,z [m], default 0,0,0",
         "delta4");
    list("--telescope-platform-m", telescope_platform_, "lower joint from the plate's centre x,y,z [m], default 0,0,0", "delta4");
    list("--rail-axis-limb", rail_axis_,
         "rail direction x,y,z in the limb frame (x outwards, z up), default 0,0,-1: positive is down", "linear-delta3");
    flag("--rail-tilt-rad", rail_tilt_, "instead: rail down and tilted outwards by this angle [rad]", "linear-delta3");
    flag("--drive-kind", drive_kind_, "revolute (default) or prismatic", "axis");
    flag("--arm", arm_, "length of the arm on a revolute drive [m]", "axis");
    list("--axis-direction", axis_direction_,
         "axis of the drive x,y,z; revolute: horizontal, default 0,1,0; prismatic: default 1,0,0", "axis");
    const char* count = "; one for all, or one a drive";
    flag("--drive-range-rad", range_rad_, "position limits lo,hi or lo,hi;lo,hi;... [rad]", "delta3 delta4 axis");
    flag("--drive-range-m", range_m_, "the same of prismatic drives [m]", "linear-delta3 axis");
    list("--drive-velocity-rad-s", velocity_rad_, std::string("velocity limits [rad/s]") + count, "delta3 delta4 axis");
    list("--drive-velocity-m-s", velocity_m_, std::string("of prismatic drives [m/s]") + count, "linear-delta3 axis");
    list("--drive-acceleration-rad-s2", acceleration_rad_, std::string("acceleration limits [rad/s^2]") + count,
         "delta3 delta4 axis");
    list("--drive-acceleration-m-s2", acceleration_m_, std::string("of prismatic drives [m/s^2]") + count, "linear-delta3 axis");
    list("--drive-effort-Nm", effort_Nm_, std::string("torque limits [N m]") + count, "delta3 delta4 axis");
    list("--drive-effort-N", effort_N_, std::string("force limits of prismatic drives [N]") + count, "linear-delta3 axis");
    c.add_option("--gravity-m-s2", gravity_, "size of gravity [m/s^2]")->capture_default_str();
    c.add_option("--gravity-direction", gravity_direction_, "direction x,y,z in the base frame, default 0,0,-1")
        ->delimiter(',')
        ->type_name("X,Y,Z");
    run.on(c, [this, &run] { execute(run); });
  }

 private:
  struct Flag {
    CLI::Option* option;
    std::string name, types;
  };

  template <class T>
  void flag(const std::string& name, std::optional<T>& value, const std::string& help, const std::string& types) {
    flags_.push_back({command_->add_option(name, value, help + " (" + types + ")"), name, types});
  }
  void list(const std::string& name, std::vector<double>& value, const std::string& help, const std::string& types) {
    flags_.push_back(
        {command_->add_option(name, value, help + " (" + types + ")")->delimiter(',')->type_name("FLOAT,..."), name, types});
  }

  void execute(ToolRun& run) {
    if (type_ == "h4" || type_ == "i4" || type_ == "par4")
      refuse_usage(fmt::format("robots of type {} cannot be created yet", type_), "use delta3, linear-delta3, delta4 or axis");
    if (type_ != "delta3" && type_ != "linear-delta3" && type_ != "delta4" && type_ != "axis")
      refuse_usage(fmt::format("'{}' is not a robot type", type_), "use delta3, linear-delta3, delta4 or axis");
    for (const Flag& f : flags_)
      if (f.option->count() > 0 && (" " + f.types + " ").find(" " + type_ + " ") == std::string::npos)
        refuse_usage(fmt::format("{} does not belong to a {}", f.name, type_), "leave it out; it is for " + f.types);
    run.check_files({output_}, {});
    RobotDescription robot;
    robot.type = type_;
    robot.name = name_.empty() ? type_ : name_;
    if (!(std::isfinite(gravity_) && gravity_ >= 0))
      refuse_usage("--gravity-m-s2 must not be negative", "give the direction by --gravity-direction");
    robot.gravity = gravity_direction_.empty()
                        ? Eigen::Vector3d(0, 0, -gravity_)
                        : Eigen::Vector3d(gravity_ * direction_of(gravity_direction_, "--gravity-direction"));
    if (type_ == "axis") {
      add_axis(robot);
    } else {
      add_limbs(robot);
    }
    add_limits(robot);
    try {
      robot.validate("");
      const auto closes = make_robot(robot);
      const WorkspaceSampler sampler(*closes);  // refuses lengths that do not close
    } catch (const Error& e) {
      refuse_usage(e.problem(), "check the lengths and limits given");  // they are the flags here, not a file's
    }
    if (output_.empty()) {
      fmt::print("{}", robot_to_urdf(robot));
    } else {
      write_robot_file(output_, robot);
      fmt::print("wrote {}: {} with {} drive{}\n", output_, robot.type, robot.drives(), robot.drives() == 1 ? "" : "s");
    }
    run.summary.add("type", robot.type);
    run.summary.add("drives", robot.drives());
  }

  static double required(const std::optional<double>& value, const std::string& name) {
    constexpr double kLargest_m = 10;  // no Delta is that large; such a number is in millimetres
    if (!value) refuse_usage(fmt::format("{} is needed for this type", name), "give it in metres");
    if (!(std::isfinite(*value) && *value >= 0)) refuse_usage(fmt::format("{} is {} m", name, *value), "give a positive length");
    if (*value > kLargest_m) refuse_usage(fmt::format("{} {} looks like millimetres", name, *value), "give it in metres");
    return *value;
  }

  double elbow() const {
    const std::string word = elbow_.value_or("outwards");
    if (word == "outwards" || word == "above") return 1;
    if (word == "inwards" || word == "below") return -1;
    refuse_usage(fmt::format("--elbow {} is not known", word), "use outwards or inwards");
  }

  Eigen::Vector3d rail() const {
    if (!rail_axis_.empty() && rail_tilt_)
      refuse_usage("--rail-axis-limb and --rail-tilt-rad exclude each other", "give one of them");
    if (!rail_axis_.empty()) return direction_of(rail_axis_, "--rail-axis-limb");
    const double tilt = rail_tilt_.value_or(0);
    return {std::sin(tilt), 0, -std::cos(tilt)};
  }

  void add_limbs(RobotDescription& robot) const {
    const bool linear = type_ == "linear-delta3";
    robot.drive_kind = linear ? DriveKind::prismatic : DriveKind::revolute;
    const double base = required(base_radius_, "--base-radius");
    const double plate = required(platform_radius_, "--platform-radius");
    for (int i = 0; i < 3; ++i) {
      LimbGeometry<double> limb;
      limb.azimuth = 2 * kPi / 3 * i;
      const Eigen::Vector3d radial(std::cos(limb.azimuth), std::sin(limb.azimuth), 0);
      limb.p_WD = base * radial;
      limb.p_BA = plate * radial;
      limb.strut = required(strut_, "--strut");
      limb.strut_spacing = spacing_.value_or(0.1);
      limb.elbow = elbow();
      if (linear) {
        limb.axis_L = rail();
      } else {
        limb.p_DE_0 = Eigen::Vector3d(required(upper_arm_, "--upper-arm"), 0, 0);
      }
      robot.limbs.push_back(limb);
    }
    robot.parts.emplace_back();
    if (type_ == "delta4") {
      robot.telescope.emplace();
      if (!telescope_base_.empty()) robot.telescope->p_WU = vector_of(telescope_base_, "--telescope-base-m");
      if (!telescope_platform_.empty()) robot.telescope->p_BV = vector_of(telescope_platform_, "--telescope-platform-m");
    }
  }

  void add_axis(RobotDescription& robot) const {
    const std::string kind = drive_kind_.value_or("revolute");
    if (kind != "revolute" && kind != "prismatic")
      refuse_usage(fmt::format("--drive-kind {} is not known", kind), "use revolute or prismatic");
    LimbGeometry<double> limb;
    if (kind == "prismatic") {
      if (arm_) refuse_usage("--arm belongs to a revolute drive", "leave it out");
      robot.drive_kind = DriveKind::prismatic;
      limb.axis_L = axis_direction_.empty() ? Eigen::Vector3d(1, 0, 0) : direction_of(axis_direction_, "--axis-direction");
    } else {
      const Eigen::Vector3d axis =
          axis_direction_.empty() ? Eigen::Vector3d(0, 1, 0) : direction_of(axis_direction_, "--axis-direction");
      if (std::abs(axis.z()) > 1e-9)
        refuse_usage("the axis of a revolute drive is horizontal in the base frame",
                     "turn gravity instead by --gravity-direction");
      limb.azimuth = std::atan2(-axis.x(), axis.y());  // the axis is +y of the limb frame
      limb.p_DE_0 = Eigen::Vector3d(arm_.value_or(0), 0, 0);
    }
    robot.limbs.push_back(limb);
  }

  void add_limits(RobotDescription& robot) const {
    const std::size_t n = robot.limbs.size() + (robot.telescope ? 1U : 0U);
    robot.limits.assign(n, DriveLimits());
    const bool linear = robot.drive_kind == DriveKind::prismatic;
    const auto wrong_unit = [&](bool given, const char* name) {
      if (given)
        refuse_usage(fmt::format("{} does not fit {} drives", name, linear ? "prismatic" : "revolute"),
                     "use the flag with the other unit");
    };
    wrong_unit((linear ? range_rad_ : range_m_).has_value(), linear ? "--drive-range-rad" : "--drive-range-m");
    wrong_unit(!(linear ? velocity_rad_ : velocity_m_).empty(), linear ? "--drive-velocity-rad-s" : "--drive-velocity-m-s");
    wrong_unit(!(linear ? acceleration_rad_ : acceleration_m_).empty(),
               linear ? "--drive-acceleration-rad-s2" : "--drive-acceleration-m-s2");
    wrong_unit(!(linear ? effort_Nm_ : effort_N_).empty(), linear ? "--drive-effort-Nm" : "--drive-effort-N");
    if (const auto& range = linear ? range_m_ : range_rad_) {
      const auto ranges = tools::spread_ranges(*range, n, linear ? "--drive-range-m" : "--drive-range-rad");
      for (std::size_t i = 0; i < n; ++i) std::tie(robot.limits[i].lower, robot.limits[i].upper) = ranges[i];
    }
    const auto set = [&](const std::vector<double>& values, const char* name, double DriveLimits::*member) {
      if (values.empty()) return;
      const std::vector<double> all = tools::spread(values, n, name);
      for (std::size_t i = 0; i < n; ++i) robot.limits[i].*member = all[i];
    };
    set(linear ? velocity_m_ : velocity_rad_, "--drive-velocity", &DriveLimits::velocity);
    set(linear ? acceleration_m_ : acceleration_rad_, "--drive-acceleration", &DriveLimits::acceleration);
    set(linear ? effort_N_ : effort_Nm_, "--drive-effort", &DriveLimits::effort);
  }

  CLI::App* command_ = nullptr;
  std::vector<Flag> flags_;
  std::string type_, output_, name_;
  std::optional<double> base_radius_, platform_radius_, upper_arm_, strut_, spacing_, rail_tilt_, arm_;
  std::optional<std::string> elbow_, drive_kind_, range_rad_, range_m_;
  std::vector<double> telescope_base_, telescope_platform_, rail_axis_, axis_direction_;
  std::vector<double> velocity_rad_, velocity_m_, acceleration_rad_, acceleration_m_, effort_Nm_, effort_N_;
  double gravity_ = 9.81;
  std::vector<double> gravity_direction_;
};

// --- info -------------------------------------------------------------------------------------

class Info {
 public:
  void add_to(CLI::App& app, ToolRun& run) {
    CLI::App& c = *app.add_subcommand("info", "Print geometry, workspace, drives, parameter and base-parameter counts.");
    tools::set_example(c, "delta-model info robot.urdf --plot workspace.png --summary info.csv");
    c.add_option("robot", robot_file_, "robot file (URDF)")->required()->type_name("ROBOT");
    c.add_flag("--without-tool", without_tool_, "leave out the tool's ten parameters (delta4)");
    c.add_flag("--individual-limbs", individual_limbs_, "every limb has parameters of its own");
    c.add_option("--plot", plot_, "picture of the workspace (PNG)")->type_name("FILE");
    run.on(c, [this, &run] { execute(run); });
  }

 private:
  void execute(ToolRun& run) {
    run.check_files({plot_}, {robot_file_});
    const RobotDescription description = read_robot_file(robot_file_);
    ParameterOptions options;
    options.tool = !without_tool_;
    options.individual_limbs = individual_limbs_;
    const auto robot = make_robot(description, options);
    fmt::print("{}: {} ({})\n", robot_file_, description.name, description.type);
    geometry(description, run.summary);
    drives(description, run.summary);
    if (!description.parts.empty()) workspace(*robot, run.summary);
    parameters(*robot, run);
  }

  static void geometry(const RobotDescription& robot, Summary& summary) {
    fmt::print("\ngeometry\n");
    for (std::size_t i = 0; i < robot.limbs.size(); ++i) {
      const auto& limb = robot.limbs[i];
      const auto name = [&](const char* key) { return fmt::format("limb{}_{}", i + 1, key); };
      fmt::print("  limb {}: azimuth {:.6g} deg, drive at ({:.6g}, {:.6g}, {:.6g}) m", i + 1, limb.azimuth * 180 / kPi,
                 limb.p_WD.x(), limb.p_WD.y(), limb.p_WD.z());
      summary.add(name("azimuth"), limb.azimuth, "rad");
      summary.add(name("base_radius"), limb.p_WD.head<2>().norm(), "m");
      if (robot.drive_kind == DriveKind::prismatic) {
        fmt::print(", rail along ({:.6g}, {:.6g}, {:.6g})", limb.axis_L.x(), limb.axis_L.y(), limb.axis_L.z());
      } else {
        fmt::print(", upper arm {:.6g} m", limb.p_DE_0.norm());
        summary.add(name("upper_arm"), limb.p_DE_0.norm(), "m");
      }
      if (!robot.parts.empty()) {
        fmt::print(", struts {:.6g} m, {:.6g} m apart, plate radius {:.6g} m", limb.strut, limb.strut_spacing,
                   limb.p_BA.head<2>().norm());
        summary.add(name("strut"), limb.strut, "m");
        summary.add(name("strut_spacing"), limb.strut_spacing, "m");
        summary.add(name("platform_radius"), limb.p_BA.head<2>().norm(), "m");
      }
      fmt::print("\n");
    }
    if (robot.telescope) {
      const auto& u = robot.telescope->p_WU;
      const auto& v = robot.telescope->p_BV;
      fmt::print("  telescope: from ({:.6g}, {:.6g}, {:.6g}) m on the base to ({:.6g}, {:.6g}, {:.6g}) m on the plate\n", u.x(),
                 u.y(), u.z(), v.x(), v.y(), v.z());
    }
    fmt::print("  gravity ({:.6g}, {:.6g}, {:.6g}) m/s^2\n", robot.gravity.x(), robot.gravity.y(), robot.gravity.z());
    summary.add("gravity", robot.gravity.norm(), "m/s^2");
  }

  static void drives(const RobotDescription& robot, Summary& summary) {
    fmt::print("\ndrives\n");
    summary.add("drives", robot.drives());
    for (int i = 0; i < robot.drives(); ++i) {
      const DriveLimits& limits = robot.limits[static_cast<std::size_t>(i)];
      const bool linear = robot.kind_of_drive(i) == DriveKind::prismatic;
      const std::string unit = linear ? "m" : "rad";
      const auto words = [](double value, const std::string& of) {
        return std::isfinite(value) ? fmt::format("{:.6g} {}", value, of) : std::string("unlimited");
      };
      const std::string range = std::isfinite(limits.lower) || std::isfinite(limits.upper)
                                    ? fmt::format("{} to {}", words(limits.lower, unit), words(limits.upper, unit))
                                    : "unlimited";
      fmt::print("  drive {} ({}): range {}, velocity {}, acceleration {}, {} {}\n", i + 1, linear ? "prismatic" : "revolute",
                 range, words(limits.velocity, unit + "/s"), words(limits.acceleration, unit + "/s^2"),
                 linear ? "force" : "torque", words(limits.effort, linear ? "N" : "N m"));
    }
  }

  void workspace(const Robot& robot, Summary& summary) const {
    const Reach reach = find_reach(robot);
    fmt::print(
        "\nworkspace (poses of the plate's centre that are in reach, inside the drives' ranges, not singular; to {:.2g} m)\n",
        reach.cell);
    fmt::print("  radius {:.3f} m, height {:.3f} to {:.3f} m, volume {:.3f} m^3, home pose ({:.3f}, {:.3f}, {:.3f}) m\n",
               reach.radius, reach.lower.z(), reach.upper.z(), reach.volume, reach.home.x(), reach.home.y(), reach.home.z());
    fmt::print("  condition number of the Jacobian: best {:.2f}, half of the workspace below {:.2f}, 95 % below {:.2f}\n",
               reach.condition_best, reach.condition_median, reach.condition_worst_of_95);
    const auto& limits = robot.description().limits;
    if (std::isinf(limits.front().lower) || std::isinf(limits.front().upper))
      fmt::print("  the drives have no position limits in the robot file; the real workspace is smaller\n");
    summary.add("workspace_radius", reach.radius, "m");
    summary.add("workspace_lowest", reach.lower.z(), "m");
    summary.add("workspace_highest", reach.upper.z(), "m");
    summary.add("workspace_volume", reach.volume, "m^3");
    summary.add("jacobian_condition_best", reach.condition_best);
    summary.add("jacobian_condition_median", reach.condition_median);
    summary.add("jacobian_condition_95", reach.condition_worst_of_95);
    if (!plot_.empty()) {
      draw(robot.description(), reach);
      fmt::print("  picture: {}\n", plot_);
    }
  }

  /// Side view of the plane y = 0 and top view at the height of the home pose, coloured by the condition number.
  void draw(const RobotDescription& robot, const Reach& reach) const {
    const auto slice = [&](int normal, double place, int horizontal, int vertical, const std::string& title) {
      PlotSpec spec;
      spec.title = title;
      spec.x_label = horizontal == 0 ? "x [m]" : "y [m]";
      spec.y_label = vertical == 2 ? "z [m]" : "y [m]";
      const struct {
        double low, high;
        const char* label;
        PlotColor color;
      } bands[] = {{0, 3, "condition below 3", PlotColor::green},
                   {3, 8, "3 to 8", PlotColor::sky},
                   {8, 1e9, "above 8", PlotColor::orange}};
      for (const auto& band : bands) {
        std::vector<double> x, y;
        for (Eigen::Index k = 0; k < reach.points.rows(); ++k) {
          if (std::abs(reach.points(k, normal) - place) > 0.5001 * reach.cell) continue;
          if (reach.condition(k) < band.low || reach.condition(k) >= band.high) continue;
          x.push_back(reach.points(k, horizontal));
          y.push_back(reach.points(k, vertical));
        }
        if (x.empty()) continue;
        const auto n = static_cast<Eigen::Index>(x.size());
        spec.series.push_back({band.label,
                               Eigen::Map<Eigen::VectorXd>(x.data(), n),
                               Eigen::Map<Eigen::VectorXd>(y.data(), n),
                               SeriesStyle::points,
                               {},
                               band.color});
      }
      Eigen::VectorXd x(robot.limbs.size()), y(robot.limbs.size());
      for (std::size_t i = 0; i < robot.limbs.size(); ++i) {
        x(static_cast<Eigen::Index>(i)) = robot.limbs[i].p_WD(horizontal);
        y(static_cast<Eigen::Index>(i)) = robot.limbs[i].p_WD(vertical);
      }
      spec.series.push_back({"drives", x, y, SeriesStyle::points, {}, PlotColor::black});
      spec.width = 700;
      spec.height = 480;
      return spec;
    };
    render_png({slice(1, 0, 0, 2, "side view, y = 0"),
                slice(2, reach.home.z(), 0, 1, fmt::format("top view, z = {:.2f} m", reach.home.z()))},
               plot_);
  }

  static void parameters(const Robot& robot, ToolRun& run) {
    BaseParameterOptions options;
    options.seed = run.seed;
    const BaseParameters base = find_base_parameters(robot, options);
    const std::string gap = base.rank_gap > 1e15 ? "above 1e15" : fmt::format("{:.1e}", base.rank_gap);
    fmt::print("\nparameters\n  {} columns, of which the drives can show {} base parameters (gap in the rank decision: {})\n",
               robot.parameters(), base.count(), gap);
    fmt::print("  condition number of the base regressor over random states: {:.3g}\n", base.condition_number);
    run.summary.add("columns", robot.parameters());
    run.summary.add("base_parameters", base.count());
    run.summary.add("rank_gap", base.rank_gap);
    run.summary.add("condition_number", base.condition_number);
    std::vector<std::string> bodies;
    for (const std::string& name : robot.parameter_names()) {
      const std::string body = name.substr(0, name.find('.'));
      if (bodies.empty() || bodies.back() != body) bodies.push_back(body);
    }
    fmt::print("  groups: {}\n", fmt::join(bodies, " "));
  }

  std::string robot_file_, plot_;
  bool without_tool_ = false, individual_limbs_ = false;
};

// --- prior ------------------------------------------------------------------------------------

class Prior {
 public:
  void add_to(CLI::App& app, ToolRun& run) {
    CLI::App& c =
        *app.add_subcommand("prior", "Nominal parameters from simple shapes and materials, scaled from the paper's robot.");
    tools::set_example(c, "delta-model prior robot.urdf --platform-mass-kg 1.0 --tool-mass-kg 0.4 -o prior.csv");
    c.add_option("robot", robot_file_, "robot file (URDF)")->required()->type_name("ROBOT");
    c.add_option("-o,--output", output_, "parameter file to write (CSV name,value,unit,std)")->required()->type_name("FILE");
    c.add_flag("--without-tool", without_tool_, "leave out the tool's ten parameters (delta4)");
    c.add_flag("--individual-limbs", individual_limbs_, "every limb has parameters of its own");
    for (Shape& shape : shapes_) c.add_option(shape.flag, shape.value, shape.help)->group("Shapes, masses, friction");
    run.on(c, [this, &run] { execute(run); });
  }

 private:
  void execute(ToolRun& run) {
    run.check_files({output_}, {robot_file_});
    const RobotDescription description = read_robot_file(robot_file_);
    ParameterOptions options;
    options.tool = !without_tool_;
    options.individual_limbs = individual_limbs_;
    const auto robot = make_robot(description, options);
    PartShapes shapes(description);
    for (const Shape& shape : shapes_)
      if (shape.value) shapes.*shape.member = *shape.value;
    const NominalParameters nominal = nominal_parameters(*robot, shapes);
    ParameterTable table;
    for (int k = 0; k < robot->parameters(); ++k) {
      ParameterEntry entry;
      entry.name = robot->parameter_names()[static_cast<std::size_t>(k)];
      entry.unit = robot->parameter_units()[static_cast<std::size_t>(k)];
      entry.value = nominal.value(k);
      entry.std = nominal.std(k);
      if (entry.name.size() > 2 && entry.name.compare(entry.name.size() - 2, 2, ".m") == 0) {
        fmt::print("  {:<18} {:8.3f} kg\n", entry.name.substr(0, entry.name.size() - 2), entry.value);
        run.summary.add("mass_" + entry.name.substr(0, entry.name.size() - 2), entry.value, "kg");
      }
      table.entries.push_back(std::move(entry));
    }
    write_parameters(output_, table);
    fmt::print("wrote {}: {} nominal parameters\n", output_, table.entries.size());
    run.summary.add("columns", robot->parameters());
  }

  struct Shape {
    std::string flag, help;
    double PartShapes::*member;
    std::optional<double> value = {};
  };

  std::string robot_file_, output_;
  bool without_tool_ = false, individual_limbs_ = false;
  std::vector<Shape> shapes_ = {
      {"--upper-arm-outer-diameter-m", "tube of the upper arm [m]", &PartShapes::upper_arm_outer_diameter},
      {"--upper-arm-wall-m", "its wall [m]", &PartShapes::upper_arm_wall},
      {"--upper-arm-density-kg-m3", "its density [kg/m^3], carbon fibre 1600", &PartShapes::upper_arm_density},
      {"--upper-arm-hub-mass-kg", "hub about the drive axis [kg], 0: none", &PartShapes::upper_arm_hub_mass},
      {"--upper-arm-hub-diameter-m", "its diameter [m]", &PartShapes::upper_arm_hub_diameter},
      {"--upper-arm-hub-width-m", "its width along the axis [m]", &PartShapes::upper_arm_hub_width},
      {"--carriage-mass-kg", "carriage of a prismatic drive [kg]", &PartShapes::carriage_mass},
      {"--carriage-diameter-m", "its diameter [m]", &PartShapes::carriage_diameter},
      {"--carriage-length-m", "its length along the rail [m]", &PartShapes::carriage_length},
      {"--strut-outer-diameter-m", "tube of a strut [m]", &PartShapes::strut_outer_diameter},
      {"--strut-wall-m", "its wall [m]", &PartShapes::strut_wall},
      {"--strut-density-kg-m3", "its density [kg/m^3]", &PartShapes::strut_density},
      {"--strut-sockets-mass-kg", "both sockets of one strut [kg], 0: none; default as heavy as the tube",
       &PartShapes::strut_sockets_mass},
      {"--strut-socket-diameter-m", "their diameter [m]", &PartShapes::strut_socket_diameter},
      {"--strut-socket-length-m", "their length [m]", &PartShapes::strut_socket_length},
      {"--platform-mass-kg", "travelling plate [kg]", &PartShapes::platform_mass},
      {"--platform-diameter-m", "its diameter [m]", &PartShapes::platform_diameter},
      {"--platform-thickness-m", "its thickness [m]", &PartShapes::platform_thickness},
      {"--tool-mass-kg", "tool [kg]", &PartShapes::tool_mass},
      {"--tool-diameter-m", "its diameter [m]", &PartShapes::tool_diameter},
      {"--tool-length-m", "its length below the plate's centre [m]", &PartShapes::tool_length},
      {"--telescope-mass-kg", "both parts of the telescope bar [kg]", &PartShapes::telescope_mass},
      {"--telescope-upper-share", "share of the upper part in that mass, the paper's is 0.6", &PartShapes::telescope_upper_share},
      {"--telescope-upper-length-m", "solid rod of the upper part [m]", &PartShapes::telescope_upper_length},
      {"--telescope-upper-diameter-m", "its diameter [m]", &PartShapes::telescope_upper_diameter},
      {"--telescope-lower-length-m", "tube of the lower part [m]", &PartShapes::telescope_lower_length},
      {"--telescope-lower-outer-diameter-m", "its outer diameter [m]", &PartShapes::telescope_lower_outer_diameter},
      {"--telescope-lower-inner-diameter-m", "its inner diameter [m]", &PartShapes::telescope_lower_inner_diameter},
      {"--drive-viscous", "friction of a limb's drive [N m s/rad or N s/m]", &PartShapes::drive_viscous},
      {"--drive-coulomb", "the same [N m or N]", &PartShapes::drive_coulomb},
      {"--telescope-drive-viscous-Nm-s-rad", "friction of the telescope's drive [N m s/rad]",
       &PartShapes::telescope_drive_viscous},
      {"--telescope-drive-coulomb-Nm", "the same [N m]", &PartShapes::telescope_drive_coulomb},
      {"--telescope-viscous-N-s-m", "friction of the sliding bar [N s/m]", &PartShapes::telescope_viscous},
      {"--telescope-coulomb-N", "the same [N]", &PartShapes::telescope_coulomb},
      {"--body-std", "assumed standard deviation of masses and moments as a share of the value, default 0.5",
       &PartShapes::body_std},
      {"--friction-std", "of the friction, default 1", &PartShapes::friction_std},
  };
};

}  // namespace

int main(int argc, char** argv) {
  Create create;
  Info info;
  Prior prior;
  return tools::run_tool(
      argc, argv,
      {"delta-model", "Robot files of Delta-like robots: make them, look at them, and guess their parameters.",
       "delta-model create delta4 --base-radius 0.2 --platform-radius 0.05 --upper-arm 0.525 --strut 1.106 -o robot.urdf\n"
       "  delta-model info robot.urdf\n"
       "  delta-model prior robot.urdf -o prior.csv"},
      [&](CLI::App& app, ToolRun& run) {
        app.require_subcommand(1);
        create.add_to(app, run);
        info.add_to(app, run);
        prior.add_to(app, run);
      });
}
