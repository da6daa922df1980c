#pragma once

/// \file
/// `delta-model info`: geometry, workspace, drives, parameter and base-parameter counts of a robot file.

#include <Eigen/Core>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numbers>
#include <string>
#include <vector>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/report/plot.hpp"
#include "deltadyn/runtime/plate_hold.hpp"
#include "deltadyn/runtime/reach.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/runtime/sketch.hpp"

#include "layout_flags.hpp"
#include "tool_support.hpp"

namespace deltadyn::tools {

class Info {
 public:
  void add_to(CLI::App& app, ToolRun& run) {
    CLI::App& c =
        *app.add_subcommand("info", "Print geometry, workspace, drives, parameter and base-parameter counts.");
    set_example(c, "delta-model info robot.urdf --plot workspace.png --summary info.csv");
    c.add_option("robot", robot_file_, "robot file (URDF)")->required()->type_name("ROBOT");
    layout_.add_bodies(c);
    c.add_option("--plot", plot_, "picture of the robot and its workspace (PNG)")->type_name("FILE");
    run.on(c, [this, &run] { execute(run); });
  }

 private:
  void execute(ToolRun& run) {
    if (!plot_.empty() && !plot_.ends_with(".png"))
      throw Error(fmt::format("--plot {}: pictures are written as PNG", plot_), "", "let the name end in .png",
                  ExitCode::usage);
    run.check_files({plot_}, {robot_file_});
    const RobotDescription description = read_robot_file(robot_file_);
    const auto robot = make_robot(description, layout_.options(description));
    fmt::print("{}: {} ({})\n", robot_file_, description.name, description.type);
    geometry(description, run.summary);
    drives(description, run.summary);
    if (!description.parts.empty()) workspace(*robot, run.summary);
    parameters(*robot, run);
  }

  /// To six digits; what rounding has left of a zero is written as one.
  static std::string words(const Eigen::Vector3d& v) {
    const auto number = [](double x) { return std::abs(x) < 1e-9 ? 0.0 : x; };
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", number(v.x()), number(v.y()), number(v.z()));
  }

  static void geometry(const RobotDescription& robot, Summary& summary) {
    fmt::print("\ngeometry\n");
    for (std::size_t i = 0; i < robot.limbs.size(); ++i) {
      const auto& limb = robot.limbs[i];
      const auto name = [&](const char* key) { return fmt::format("limb{}_{}", i + 1, key); };
      fmt::print("  limb {}: azimuth {:.6g} deg,{} drive at {} m", i + 1, limb.azimuth * 180 / std::numbers::pi,
                 limb.tilt != 0 ? fmt::format(" tilt {:.6g} deg,", limb.tilt * 180 / std::numbers::pi) : "",
                 words(limb.p_WD));
      summary.add(name("azimuth"), limb.azimuth, "rad");
      summary.add(name("base_radius"), limb.p_WD.head<2>().norm(), "m");
      if (robot.drive_kind == DriveKind::prismatic) {
        fmt::print(", rail along {}", words(limb.axis_L));
      } else {
        fmt::print(", upper arm {:.6g} m", limb.p_DE_0.norm());
        summary.add(name("upper_arm"), limb.p_DE_0.norm(), "m");
      }
      if (!robot.parts.empty()) {
        fmt::print(", struts {:.6g} m, {:.6g} m apart, ", limb.strut, limb.strut_spacing);
        if (robot.plate) {
          fmt::print("on half plate {}, {} m from its origin", limb.part + 1, words(limb.p_BA));
          summary.add(name("half_plate"), limb.part + 1);
        } else {
          fmt::print("plate radius {:.6g} m", limb.p_BA.head<2>().norm());
        }
        summary.add(name("strut"), limb.strut, "m");
        summary.add(name("strut_spacing"), limb.strut_spacing, "m");
        summary.add(name("platform_radius"), limb.p_BA.head<2>().norm(), "m");
      }
      fmt::print("\n");
    }
    if (robot.plate) {
      const PlateShape& plate = *robot.plate;
      fmt::print("  plate: ");
      if (plate.spacing > 0) fmt::print("hinges of the halves {:.6g} m apart, ", plate.spacing);
      if (plate.bar_spacing > 0) fmt::print("bars {:.6g} m apart, ", plate.bar_spacing);
      if (plate.pinion_radius > 0) fmt::print("pinion of radius {:.6g} m, ", plate.pinion_radius);
      fmt::print("half 1 at azimuth {:.6g} deg, turn +-{:.6g} deg, tool {:.6g} times that\n",
                 plate.azimuth * 180 / std::numbers::pi, plate.range * 180 / std::numbers::pi, plate.ratio);
    }
    if (robot.telescope) {
      fmt::print("  telescope: from {} m on the base to {} m on the plate\n", words(robot.telescope->p_WU),
                 words(robot.telescope->p_BV));
    }
    fmt::print("  gravity {} m/s^2\n", words(robot.gravity));
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
      fmt::print("  drive {} ({}): range {}, velocity {}, acceleration {}, {} {}\n", i + 1,
                 linear ? "prismatic" : "revolute", range, words(limits.velocity, unit + "/s"),
                 words(limits.acceleration, unit + "/s^2"), linear ? "force" : "torque",
                 words(limits.effort, linear ? "N" : "N m"));
    }
  }

  void workspace(const Robot& robot, Summary& summary) const {
    const Reach reach = find_reach(robot);
    fmt::print(
        "\nworkspace (poses of the plate's centre that are in reach, inside the drives' ranges, not singular; to "
        "{:.2g} m)\n",
        reach.cell);
    fmt::print("  radius {:.3f} m, height {:.3f} to {:.3f} m, volume {:.3f} m^3, home pose {} m\n", reach.radius,
               reach.lower.z(), reach.upper.z(), reach.volume, words((1e3 * reach.home).array().round() / 1e3));
    fmt::print(
        "  condition number of the Jacobian: best {:.2f}, half of the workspace below {:.2f}, 95 % below {:.2f}\n",
        reach.condition_best, reach.condition_median, reach.condition_worst_of_95);
    if (const double range = robot.description().plate_yaw_range(); range > 0) {
      fmt::print(
          "  the plate turns the tool by {:.4g} deg to either side; with it turned that far {:.0f} % of this volume "
          "are left\n",
          range * 180 / std::numbers::pi, 100 * reach.share_at_full_turn);
      Eigen::VectorXd z = Eigen::VectorXd::Zero(robot.drives()), q(robot.drives());
      z.head<3>() = reach.home;
      if (robot.inverse_kinematics(z, q) == Status::ok) {
        const double margin = tipping_margin(robot, q);
        summary.add("plate_tipping_margin", margin);
        if (margin < kLeastTippingMargin)
          fmt::print(
              "  in the home pose both halves of the plate may tip about the same axis (margin {:.2g} of 1)\n    {}\n",
              margin, kTippingMend);
      }
      summary.add("yaw_range", range, "rad");
      summary.add("workspace_share_at_full_turn", reach.share_at_full_turn);
    }
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
      draw(robot, reach);
      fmt::print("  picture: {}\n", plot_);
    }
  }

  /// The robot at its home pose, seen from above and the side.
  static PlotSpec picture(const Robot& robot, const Eigen::VectorXd& home) {
    constexpr double kAzimuth = 0.45, kElevation = 0.4;  // of the eye [rad]
    const Eigen::Vector3d right(-std::sin(kAzimuth), std::cos(kAzimuth), 0);
    const Eigen::Vector3d up(-std::sin(kElevation) * std::cos(kAzimuth), -std::sin(kElevation) * std::sin(kAzimuth),
                             std::cos(kElevation));
    PlotSpec spec;
    spec.title = fmt::format("{} at its home pose, oblique view (across and upwards in m)", robot.description().type);
    spec.x_label = "to the right [m]";
    spec.y_label = "upwards in the picture [m]";
    const PlotColor colors[] = {PlotColor::black, PlotColor::vermillion, PlotColor::blue,
                                PlotColor::green, PlotColor::orange,     PlotColor::purple};
    std::size_t color = 0;
    for (const SketchLines& one : sketch_of(robot, home)) {
      Series series;
      series.label = one.label;
      series.color = colors[color++ % std::size(colors)];
      const auto n = static_cast<Eigen::Index>(one.lines.size());
      series.x = series.y = Eigen::VectorXd::Constant(3 * n, std::nan(""));  // the third point is a gap
      for (Eigen::Index k = 0; k < n; ++k) {
        const auto& [from, to] = one.lines[static_cast<std::size_t>(k)];
        series.x.segment<2>(3 * k) << right.dot(from), right.dot(to);
        series.y.segment<2>(3 * k) << up.dot(from), up.dot(to);
      }
      spec.series.push_back(std::move(series));
    }
    spec.width = 700;
    spec.height = 620;
    return spec;
  }

  /// Side view of the plane y = 0 and top view at the height of the home pose, coloured by the condition number.
  void draw(const Robot& model, const Reach& reach) const {
    const RobotDescription& robot = model.description();
    Eigen::VectorXd z = Eigen::VectorXd::Zero(model.drives()), home(model.drives());
    z.head<3>() = reach.home;
    if (model.inverse_kinematics(z, home) != Status::ok)
      throw Error("the home pose is out of reach", robot_file_, "check the lengths in the robot file");
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
                   {3, 8, "condition 3 to 8", PlotColor::sky},
                   {8, 1e9, "condition above 8", PlotColor::orange}};
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
    render_png({picture(model, home), slice(1, 0, 0, 2, "side view, y = 0"),
                slice(2, reach.home.z(), 0, 1, fmt::format("top view, z = {:.2f} m", reach.home.z()))},
               plot_);
  }

  static void parameters(const Robot& robot, ToolRun& run) {
    BaseParameterOptions options;
    options.seed = run.seed;
    const BaseParameters base = find_base_parameters(robot, options);
    const std::string gap = base.rank_gap > 1e15 ? "above 1e15" : fmt::format("{:.1e}", base.rank_gap);
    fmt::print(
        "\nparameters\n  {} columns, of which the drives can show {} base parameters (gap in the rank decision: {})\n",
        robot.parameters(), base.count(), gap);
    fmt::print("  condition number of the base regressor over random states: {:.3g}\n", base.condition_number);
    run.summary.add("columns", robot.parameters());
    run.summary.add("base_parameters", base.count());
    run.summary.add("rank_gap", base.rank_gap);
    run.summary.add("condition_number", base.condition_number);
    std::vector<std::string> bodies;
    for (const ParameterId& id : robot.parameter_ids()) {
      const std::string body = owner_name(id);
      if (bodies.empty() || bodies.back() != body) bodies.push_back(body);
    }
    fmt::print("  groups: {}\n", fmt::join(bodies, " "));
  }

  std::string robot_file_, plot_;
  LayoutFlags layout_;
};

}  // namespace deltadyn::tools
