#pragma once

/// \file
/// The limits that a motion of delta-excite keeps: of the drives, of the plate and of its turning.

#include <fmt/format.h>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "deltadyn/trajectory/motion_limits.hpp"

#include "excite/list_flags.hpp"
#include "excite/workspace_flags.hpp"
#include "tool_support.hpp"

namespace deltadyn::tools {

/// One limit of the drives, which has a flag for drives that turn and one for drives that slide.
template <class Value>
struct DriveFlag {
  const char *turning, *sliding;
  Value of_turning = {}, of_sliding = {};

  [[nodiscard]] const char* name(bool slides) const { return slides ? sliding : turning; }
  [[nodiscard]] const Value& value(bool slides) const { return slides ? of_sliding : of_turning; }
  /// Throws Error(usage) if the flag of the other kind of drives is given.
  void refuse_other(bool slides) const {
    if (!value(!slides).empty())
      throw Error(fmt::format("{} is not the unit of the drives of this robot", name(!slides)), "",
                  slides ? "use the flags in metres" : "use the flags in radians", ExitCode::usage);
  }
};

class LimitFlags {
 public:
  void add_to(CLI::App& app) {
    workspace_.add_to(app);
    app.option_defaults()->group("Limits; lists hold one number for all drives, or one for each, with commas");
    const auto list = [&app](DriveFlag<std::vector<double>>& flag, const char* what, const char* turning,
                             const char* sliding) {
      add_list(app, flag.turning, flag.of_turning, fmt::format("{} [{}] [the robot file's]", what, turning));
      add_list(app, flag.sliding, flag.of_sliding, fmt::format("the same of prismatic drives [{}]", sliding));
    };
    app.add_option(range_.turning, range_.of_turning,
                   "position limits lo,hi or lo,hi;lo,hi;.. [rad] [the robot file's]");
    app.add_option(range_.sliding, range_.of_sliding, "the same of prismatic drives [m]");
    list(velocity_, "velocity limits", "rad/s", "m/s");
    list(acceleration_, "acceleration limits", "rad/s^2", "m/s^2");
    list(effort_, "torque limits, with --params", "N m", "N");
    add_list(app, "--platform-velocity-m-s", plate_velocity_,
             "of the plate, along each of x, y, z: one or three [m/s] [not limited]");
    add_list(app, "--platform-acceleration-m-s2", plate_acceleration_, "the same [m/s^2] [not limited]");
    app.add_option("--yaw-velocity-rad-s", yaw_velocity_, "of the tool's turning [rad/s] [not limited]");
    app.add_option("--yaw-acceleration-rad-s2", yaw_acceleration_, "the same [rad/s^2] [not limited]");
    app.add_option("--yaw-range-rad", yaw_range_, "largest angle of the tool to either side [rad] [the drive's range]");
  }

  /// The limits of the flags over those of the robot file; what exceeds the file is told. Throws Error(usage).
  /// \param model  values of the robot's parameters, without which torque is not limited; null: none is known
  [[nodiscard]] MotionLimits limits(const Robot& robot, const Eigen::VectorXd* model) const {
    const RobotDescription& description = robot.description();
    MotionLimits limits(description);
    set_drive_limits(description, limits);
    const bool slides = description.drive_kind == DriveKind::prismatic;
    if (!effort_.value(slides).empty() && model == nullptr)
      throw Error("a torque limit needs a model of the robot", effort_.name(slides),
                  "give --params, or leave the flag out", ExitCode::usage);
    if (model != nullptr) limits.parameters = *model;
    set_task_limits(robot, limits);
    limits.validate(description);
    for (const std::string& beyond : limits.beyond_file(description)) fmt::print("note: {}\n", beyond);
    return limits;
  }

 private:
  void set_drive_limits(const RobotDescription& robot, MotionLimits& limits) const {
    const int n = robot.drives();
    const bool slides = robot.drive_kind == DriveKind::prismatic;
    range_.refuse_other(slides);
    for (const auto* flag : {&velocity_, &acceleration_, &effort_}) flag->refuse_other(slides);
    if (!range_.value(slides).empty()) {
      const auto ranges = spread_ranges(range_.value(slides), static_cast<std::size_t>(n), range_.name(slides));
      for (int i = 0; i < n; ++i) std::tie(limits.q_lower(i), limits.q_upper(i)) = ranges[static_cast<std::size_t>(i)];
    }
    const auto set = [&](const DriveFlag<std::vector<double>>& flag, Eigen::VectorXd& to) {
      if (!flag.value(slides).empty()) to = spread_vector(flag.value(slides), n, flag.name(slides));
    };
    set(velocity_, limits.qd);
    set(acceleration_, limits.qdd);
    set(effort_, limits.tau);
  }

  void set_task_limits(const Robot& robot, MotionLimits& limits) const {
    const RobotDescription& description = robot.description();
    const bool plate = !description.parts.empty();
    const auto refuse = [](bool given, const char* flag, const char* why) {
      if (given) throw Error(fmt::format("{} has no meaning: {}", flag, why), "", "leave it out", ExitCode::usage);
    };
    refuse(!plate && (workspace_.given() || !plate_velocity_.empty() || !plate_acceleration_.empty()),
           "a workspace or platform flag", "an axis has no plate");
    refuse(description.drives() < 4 && (yaw_velocity_ || yaw_acceleration_ || yaw_range_), "a yaw flag",
           "the robot has no fourth coordinate");
    if (yaw_velocity_) limits.zd(3) = *yaw_velocity_;
    if (yaw_acceleration_) limits.zdd(3) = *yaw_acceleration_;
    if (yaw_range_ && description.plate && *yaw_range_ > description.plate_yaw_range() * (1 + 1e-9))
      throw Error(
          fmt::format("--yaw-range-rad asks for {:.6g} rad, but the plate turns the tool by {:.6g} rad to either "
                      "side at most",
                      *yaw_range_, description.plate_yaw_range()),
          "", "ask for less, or mend range_rad of <plate> in the robot file", ExitCode::usage);
    if (yaw_range_) {
      limits.z_lower(3) = -*yaw_range_;
      limits.z_upper(3) = *yaw_range_;
    }
    if (description.plate && !(yaw_velocity_ && yaw_acceleration_))
      fmt::print(
          "note: without --yaw-velocity-rad-s and --yaw-acceleration-rad-s2 the tool turns as fast as the drives "
          "can\n");
    if (!plate) return;
    if (!plate_velocity_.empty()) limits.zd.head<3>() = spread_vector(plate_velocity_, 3, "--platform-velocity-m-s");
    if (!plate_acceleration_.empty())
      limits.zdd.head<3>() = spread_vector(plate_acceleration_, 3, "--platform-acceleration-m-s2");
    limits.region = workspace_.region(robot);
  }

  WorkspaceFlags workspace_;
  DriveFlag<std::string> range_{"--drive-range-rad", "--drive-range-m"};
  DriveFlag<std::vector<double>> velocity_{"--drive-velocity-rad-s", "--drive-velocity-m-s"};
  DriveFlag<std::vector<double>> acceleration_{"--drive-acceleration-rad-s2", "--drive-acceleration-m-s2"};
  DriveFlag<std::vector<double>> effort_{"--drive-torque-n-m", "--drive-force-n"};
  std::vector<double> plate_velocity_, plate_acceleration_;
  std::optional<double> yaw_velocity_, yaw_acceleration_, yaw_range_;
};

}  // namespace deltadyn::tools
