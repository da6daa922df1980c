#pragma once

/// \file
/// `delta-model create`: a robot file from a few lengths.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/runtime/geometry_of.hpp"
#include "deltadyn/runtime/plausibility.hpp"
#include "deltadyn/runtime/reach.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/runtime/workspace.hpp"

#include "model/plate_flags.hpp"
#include "tool_support.hpp"

namespace deltadyn::tools {

inline Eigen::Vector3d vector_of(const std::vector<double>& values, const std::string& flag) {
  if (values.size() != 3)
    refuse_usage(fmt::format("{} has {} numbers", flag, values.size()), "give three, separated by commas");
  return {values[0], values[1], values[2]};
}

inline Eigen::Vector3d direction_of(const std::vector<double>& values, const std::string& flag) {
  const Eigen::Vector3d v = vector_of(values, flag);
  if (!(v.norm() > 1e-9 && v.allFinite())) refuse_usage(flag + " is no direction", "give a vector that is not zero");
  return v.normalized();
}

class Create {
 public:
  void add_to(CLI::App& app, ToolRun& run) {
    command_ = app.add_subcommand("create", "Make a robot file (URDF with URDF+ loops) from a few lengths.");
    CLI::App& c = *command_;
    set_example(
        c,
        "delta-model create delta4 --base-radius 0.2 --platform-radius 0.05 --upper-arm 0.525 --strut 1.106 \\\n"
        "      --strut-spacing 0.1 --drive-velocity-rad-s 6,6,6,48 -o robot.urdf\n"
        "  delta-model create linear-delta3 --base-radius 0.3 --platform-radius 0.06 --strut 0.8 --drive-range-m "
        "0,0.9 -o l.urdf\n"
        "  delta-model create par4 --base-radius 0.15 --platform-radius 0.09 --upper-arm 0.2 --strut 0.51 \\\n"
        "      --plate-spacing 0.127 --plate-bar-spacing 0.06 --tool-ratio 4 -o par4.urdf\n"
        "  delta-model create axis --drive-kind prismatic --axis-direction 1,0,0 -o axis.urdf");
    c.add_option("type", type_, robot_type_names())->required()->type_name("TYPE");
    c.add_option("-o,--output", output_, "robot file to write [standard output]")->type_name("FILE");
    c.add_option("--name", name_, "name of the robot [its type]");
    flag("--base-radius", base_radius_, "drive i at this distance from z, at the azimuth of its limb [m]", kAll);
    flag("--platform-radius", platform_radius_,
         "attachments of the limbs from the plate's centre (of an articulated plate: in its middle) [m]", kAll);
    flag("--upper-arm", upper_arm_, "drive axis to elbow [m]", kWithArms);
    flag("--strut", strut_, "strut, ball centre to ball centre [m]", kAll);
    flag("--strut-spacing", spacing_, "distance of the two struts of a limb [m], default 0.1", kAll);
    list("--limb-azimuth-rad", azimuths_,
         "azimuth of each limb [rad], default 0, 120, 240 deg; of four limbs 45, 135, 225, 315 deg", kAll);
    list("--limb-tilt-rad", tilts_, "tilt of the limb frames about their own x [rad], one for all or one a limb", kAll);
    flag("--drive-places-m", places_, "instead of --base-radius: x,y,z of each drive; x,y,z;x,y,z;... [m]", kAll);
    flag("--attachments-m", attachments_,
         "instead of --platform-radius: x,y,z of each limb's attachment from the plate's centre, of an articulated "
         "plate "
         "from the hinge or middle of its half [m]",
         kAll);
    flag("--elbow", elbow_, "outwards (default) or inwards; of carriages: above (default) or below", kAll);
    list("--telescope-base-m", telescope_base_,
         "upper joint of the telescope bar from the base origin x,y,z [m], default 0,0,0", "delta4");
    list("--telescope-platform-m", telescope_platform_, "lower joint from the plate's centre x,y,z [m], default 0,0,0",
         "delta4");
    list("--rail-axis-limb", rail_axis_,
         "rail direction x,y,z in the limb frame (x outwards, z up), default 0,0,-1: positive is down", kWithRails);
    flag("--rail-tilt-rad", rail_tilt_, "instead: rail down and tilted outwards by this angle [rad]", kWithRails);
    flag("--plate-spacing", plate_.spacing, "between the hinges of the two halves of the plate [m]",
         types_needing(&PlateShape::spacing));
    flag("--plate-bar-spacing", plate_.bar_spacing, "between the two bars of the plate's parallelogram [m]",
         types_needing(&PlateShape::bar_spacing));
    flag("--pinion-radius", plate_.pinion_radius, "of the pinion that the halves turn [m]",
         types_needing(&PlateShape::pinion_radius));
    flag("--tool-ratio", plate_.ratio, "turns of the tool for a turn of the plate, by gear or belt, default 1; par4: 4",
         types_where([](auto type) { return decltype(type)::kGeared; }));
    flag("--tool-on", plate_.tool_on, "centre (default) or half_plate: where the tool's axis stands",
         types_where([](auto type) { return decltype(type)::kToolOnAHalf; }));
    flag("--plate-azimuth-rad", plate_.azimuth,
         "of half plate 1 from the plate's centre [rad], default the middle of limbs 1 and 2", kFourLimbs);
    flag("--plate-range-rad", plate_.range, "largest turn of the plate to either side [rad], default 0.9; i4: 2.5",
         kFourLimbs);
    flag("--drive-kind", drive_kind_, "revolute (default) or prismatic", kFourLimbs + " axis");
    flag("--arm", arm_, "length of the arm on a revolute drive [m]", "axis");
    list("--axis-direction", axis_direction_,
         "axis of the drive x,y,z; revolute: horizontal, default 0,1,0; prismatic: default 1,0,0", "axis");
    const char* count = "; one for all, or one a drive";
    flag("--drive-range-rad", range_rad_, "position limits lo,hi or lo,hi;lo,hi;... [rad]", kWithArms + " axis");
    flag("--drive-range-m", range_m_, "the same of prismatic drives [m]", kWithRails + " axis");
    list("--drive-velocity-rad-s", velocity_rad_, std::string("velocity limits [rad/s]") + count, kWithArms + " axis");
    list("--drive-velocity-m-s", velocity_m_, std::string("of prismatic drives [m/s]") + count, kWithRails + " axis");
    list("--drive-acceleration-rad-s2", acceleration_rad_, std::string("acceleration limits [rad/s^2]") + count,
         kWithArms + " axis");
    list("--drive-acceleration-m-s2", acceleration_m_, std::string("of prismatic drives [m/s^2]") + count,
         kWithRails + " axis");
    list("--drive-effort-Nm", effort_Nm_, std::string("torque limits [N m]") + count, kWithArms + " axis");
    list("--drive-effort-N", effort_N_, std::string("force limits of prismatic drives [N]") + count,
         kWithRails + " axis");
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
        {command_->add_option(name, value, help + " (" + types + ")")->delimiter(',')->type_name("FLOAT,..."), name,
         types});
  }

  void execute(ToolRun& run) {
    if ((", " + robot_type_names() + ",").find(", " + type_ + ",") == std::string::npos)
      refuse_usage(fmt::format("'{}' is not a robot type", type_), "use " + robot_type_names());
    for (const Flag& f : flags_)
      if (f.option->count() > 0 && !has_word(f.types, type_))
        refuse_usage(fmt::format("{} does not belong to {} {}", f.name,
                                 std::string("aeiouh").find(type_.front()) == std::string::npos ? "a" : "an", type_),
                     "leave it out; it is for " + f.types);
    run.check_files({output_}, {});
    RobotDescription robot;
    robot.type = type_;
    robot.name = name_.empty() ? type_ : name_;
    if (gravity_ < 0) refuse_usage("--gravity-m-s2 must not be negative", "give the direction by --gravity-direction");
    plausibility::require(plausibility::kGravity, gravity_, "--gravity-m-s2", "", ExitCode::usage);
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
      require_poses(robot);
      (void)robot_from_urdf(robot_to_urdf(robot), "");
      warn_of_tipping(*closes, WorkspaceSampler(*closes).ball().centre);
    } catch (const Error& e) {
      // They are the flags here, not a file's.
      refuse_usage(e.problem(), e.mend().empty() ? "check the lengths and limits given" : e.mend());
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

  /// A robot that never stands inside its limits is of no use to the other tools: which flag is in the way?
  void require_poses(RobotDescription robot) const {
    constexpr double kNoLimit = std::numeric_limits<double>::infinity();
    if (robot.parts.empty()) return;
    const auto problem = [](const RobotDescription& one) -> std::optional<Error> {
      try {
        (void)find_reach(*make_robot(one));
        return std::nullopt;
      } catch (const Error& e) {
        return e;
      }
    };
    const std::optional<Error> told = problem(robot);
    if (!told) return;
    RobotDescription wide = robot;
    for (DriveLimits& limit : wide.limits) std::tie(limit.lower, limit.upper) = std::pair(-kNoLimit, kNoLimit);
    for (auto& limb : robot.limbs) limb.elbow = -limb.elbow;
    std::string mend = told->mend();
    if (!problem(robot)) {
      mend = fmt::format("give --elbow {}, with which there are some", elbow_word(robot.limbs.front().elbow));
    } else if (!problem(wide)) {
      mend = fmt::format("widen {}, without which there are some", linear() ? "--drive-range-m" : "--drive-range-rad");
    } else if (mend.find("robot file") != std::string::npos) {
      mend = fmt::format("check the lengths, {}--limb-azimuth-rad{}", linear() ? "the direction of the rails, " : "",
                         four_limbs() ? " and --plate-azimuth-rad" : "");
    }
    refuse_usage(told->problem(), mend);
  }

  [[nodiscard]] const char* elbow_word(double elbow) const {
    return elbow > 0 ? (linear() ? "above" : "outwards") : (linear() ? "below" : "inwards");
  }

  double elbow() const {
    const std::string word = elbow_.value_or("outwards");
    if (word == "outwards" || word == "above") return 1;
    if (word == "inwards" || word == "below") return -1;
    refuse_usage(fmt::format("--elbow {} is not known", word),
                 fmt::format("use {} or {}", elbow_word(1), elbow_word(-1)));
  }

  Eigen::Vector3d rail() const {
    if (!rail_axis_.empty() && rail_tilt_)
      refuse_usage("--rail-axis-limb and --rail-tilt-rad exclude each other", "give one of them");
    if (!rail_axis_.empty()) return direction_of(rail_axis_, "--rail-axis-limb");
    const double tilt = rail_tilt_.value_or(0);
    plausibility::require(plausibility::kTilt, tilt, "--rail-tilt-rad", "", ExitCode::usage);
    return {std::sin(tilt), 0, -std::cos(tilt)};
  }

  [[nodiscard]] bool four_limbs() const { return has_word(kFourLimbs, type_); }

  /// Rails in place of arms.
  [[nodiscard]] bool linear() const {
    const std::string kind = drive_kind_.value_or(type_ == LinearDelta3::kName ? "prismatic" : "revolute");
    if (kind != "revolute" && kind != "prismatic")
      refuse_usage(fmt::format("--drive-kind {} is not known", kind), "use revolute or prismatic");
    return kind == "prismatic";
  }

  [[nodiscard]] std::vector<double> azimuths(std::size_t limbs) const {
    std::vector<double> all;
    for (std::size_t i = 0; i < limbs; ++i)
      all.push_back(2 * std::numbers::pi / static_cast<double>(limbs) * static_cast<double>(i) +
                    (limbs == 4 ? std::numbers::pi / 4 : 0));
    if (azimuths_.empty()) return all;
    if (azimuths_.size() == limbs) return azimuths_;
    refuse_usage(fmt::format("--limb-azimuth-rad has {} values, but the robot has {} limbs", azimuths_.size(), limbs),
                 fmt::format("give {}, one a limb", limbs));
  }

  /// Points x,y,z;x,y,z;... of each limb.
  static std::vector<Eigen::Vector3d> points(const std::string& text, std::size_t limbs, const std::string& flag) {
    std::vector<Eigen::Vector3d> all;
    std::istringstream entries(text);
    for (std::string entry; std::getline(entries, entry, ';');) {
      Eigen::Vector3d point;
      char comma[2] = {};
      std::string rest;
      std::istringstream words(entry);
      if (!(words >> point.x() >> comma[0] >> point.y() >> comma[1] >> point.z()) || comma[0] != ',' ||
          comma[1] != ',' || words >> rest)
        refuse_usage(fmt::format("{}: '{}' is not a point", flag, entry), "write x,y,z;x,y,z;... in metres");
      for (const double number : point) plausibility::require(plausibility::kOffset, number, flag, "", ExitCode::usage);
      all.push_back(point);
    }
    if (all.size() != limbs)
      refuse_usage(fmt::format("{} gives {} points", flag, all.size()), fmt::format("give {}, one a limb", limbs));
    return all;
  }

  void add_limbs(RobotDescription& robot) const {
    robot.drive_kind = linear() ? DriveKind::prismatic : DriveKind::revolute;
    const std::size_t limbs = four_limbs() ? 4 : 3;
    const std::vector<double> azimuth = azimuths(limbs);
    const std::vector<double> tilt =
        tilts_.empty() ? std::vector<double>(limbs, 0.0) : spread(tilts_, limbs, "--limb-tilt-rad");
    if (four_limbs()) {
      robot.set_plate(plate_.shape_for(robot, azimuth));
    } else {
      robot.parts.emplace_back();
    }
    std::vector<Eigen::Vector3d> places, ends;
    if (places_) places = points(*places_, limbs, "--drive-places-m");
    if (attachments_) ends = points(*attachments_, limbs, "--attachments-m");
    if (places_ && base_radius_)
      refuse_usage("--base-radius and --drive-places-m exclude each other", "give one of them");
    if (attachments_ && platform_radius_)
      refuse_usage("--platform-radius and --attachments-m exclude each other", "give one of them");
    for (std::size_t i = 0; i < limbs; ++i) {
      LimbGeometry<double> limb;
      limb.azimuth = azimuth[i];
      limb.tilt = tilt[i];
      plausibility::require(plausibility::kLimbTilt, limb.tilt, "--limb-tilt-rad", "", ExitCode::usage);
      limb.part = four_limbs() && i >= 2 ? 1 : 0;
      const Eigen::Vector3d radial(std::cos(limb.azimuth), std::sin(limb.azimuth), 0);
      limb.p_WD = places_ ? places[i] : Eigen::Vector3d(required(base_radius_, "--base-radius") * radial);
      limb.p_BA = attachments_ ? ends[i]
                               : Eigen::Vector3d(required(platform_radius_, "--platform-radius") * radial -
                                                 robot.parts[static_cast<std::size_t>(limb.part)].a);
      limb.strut = required(strut_, "--strut");
      limb.strut_spacing = spacing_.value_or(0.1);
      limb.elbow = elbow();
      if (linear()) {
        if (upper_arm_) refuse_usage("--upper-arm belongs to revolute drives", "leave it out");
        limb.axis_L = rail();
      } else {
        if (!rail_axis_.empty() || rail_tilt_)
          refuse_usage("a rail belongs to prismatic drives", "leave it out, or give --drive-kind prismatic");
        limb.p_DE_0 = Eigen::Vector3d(required(upper_arm_, "--upper-arm"), 0, 0);
      }
      robot.limbs.push_back(limb);
    }
    if (type_ == "delta4") {
      robot.telescope.emplace();
      if (!telescope_base_.empty()) robot.telescope->p_WU = vector_of(telescope_base_, "--telescope-base-m");
      if (!telescope_platform_.empty())
        robot.telescope->p_BV = vector_of(telescope_platform_, "--telescope-platform-m");
    }
  }

  /// What says the same with a horizontal axis: the frame turned so that the axis is its y, and gravity turned along.
  static std::string gravity_instead_of(const Eigen::Vector3d& axis, const Eigen::Vector3d& gravity) {
    if (gravity.isZero()) return "leave --axis-direction out: without gravity all directions are alike";
    const Eigen::Vector3d seen =
        Eigen::Quaterniond::FromTwoVectors(axis, Eigen::Vector3d::UnitY()) * gravity.normalized();
    std::string text;
    for (int k = 0; k < 3; ++k)
      text += fmt::format("{}{:.6g}", k > 0 ? "," : "", std::abs(seen(k)) < 1e-12 ? 0.0 : seen(k));
    return fmt::format(
        "leave --axis-direction out (the axis then is 0,1,0) and lean gravity against it as it is against yours: "
        "--gravity-direction {}",
        text);
  }

  void add_axis(RobotDescription& robot) const {
    const std::string kind = drive_kind_.value_or("revolute");
    if (kind != "revolute" && kind != "prismatic")
      refuse_usage(fmt::format("--drive-kind {} is not known", kind), "use revolute or prismatic");
    LimbGeometry<double> limb;
    if (kind == "prismatic") {
      if (arm_) refuse_usage("--arm belongs to a revolute drive", "leave it out");
      robot.drive_kind = DriveKind::prismatic;
      limb.axis_L =
          axis_direction_.empty() ? Eigen::Vector3d(1, 0, 0) : direction_of(axis_direction_, "--axis-direction");
    } else {
      const Eigen::Vector3d axis =
          axis_direction_.empty() ? Eigen::Vector3d(0, 1, 0) : direction_of(axis_direction_, "--axis-direction");
      if (std::abs(axis.z()) > 1e-9)
        refuse_usage("the axis of a revolute drive is horizontal in the base frame",
                     gravity_instead_of(axis, robot.gravity));
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
    wrong_unit(!(linear ? velocity_rad_ : velocity_m_).empty(),
               linear ? "--drive-velocity-rad-s" : "--drive-velocity-m-s");
    wrong_unit(!(linear ? acceleration_rad_ : acceleration_m_).empty(),
               linear ? "--drive-acceleration-rad-s2" : "--drive-acceleration-m-s2");
    wrong_unit(!(linear ? effort_Nm_ : effort_N_).empty(), linear ? "--drive-effort-Nm" : "--drive-effort-N");
    if (const auto& range = linear ? range_m_ : range_rad_) {
      const auto ranges = spread_ranges(*range, n, linear ? "--drive-range-m" : "--drive-range-rad");
      for (std::size_t i = 0; i < n; ++i) std::tie(robot.limits[i].lower, robot.limits[i].upper) = ranges[i];
    }
    const auto set = [&](const std::vector<double>& values, const char* name, double DriveLimits::*member) {
      if (values.empty()) return;
      const std::vector<double> all = spread(values, n, name);
      for (std::size_t i = 0; i < n; ++i) robot.limits[i].*member = all[i];
    };
    set(linear ? velocity_m_ : velocity_rad_, "--drive-velocity", &DriveLimits::velocity);
    set(linear ? acceleration_m_ : acceleration_rad_, "--drive-acceleration", &DriveLimits::acceleration);
    set(linear ? effort_N_ : effort_Nm_, "--drive-effort", &DriveLimits::effort);
  }

  inline static const std::string kFourLimbs = types_where([](auto) { return true; }),
                                  kWithArms = "delta3 delta4 " + kFourLimbs, kWithRails = "linear-delta3 " + kFourLimbs,
                                  kAll = "delta3 delta4 " + kWithRails;
  CLI::App* command_ = nullptr;
  std::vector<Flag> flags_;
  std::string type_, output_, name_;
  std::optional<double> base_radius_, platform_radius_, upper_arm_, strut_, spacing_, rail_tilt_, arm_;
  std::optional<std::string> elbow_, drive_kind_, range_rad_, range_m_, places_, attachments_;
  PlateFlags plate_;
  std::vector<double> azimuths_, tilts_;
  std::vector<double> telescope_base_, telescope_platform_, rail_axis_, axis_direction_;
  std::vector<double> velocity_rad_, velocity_m_, acceleration_rad_, acceleration_m_, effort_Nm_, effort_N_;
  double gravity_ = 9.81;
  std::vector<double> gravity_direction_;
};

}  // namespace deltadyn::tools
