#pragma once

/// \file
/// Lengths of an articulated plate on the command line of `delta-model create`.

#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <vector>

#include "deltadyn/model/robot_types.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/plate_hold.hpp"
#include "deltadyn/runtime/plausibility.hpp"
#include "deltadyn/runtime/robot.hpp"

namespace deltadyn::tools {

/// Is `word` one of the words?
inline bool has_word(const std::string& words, const std::string& word) {
  return (" " + words + " ").find(" " + word + " ") != std::string::npos;
}

[[noreturn]] inline void refuse_usage(const std::string& what, const std::string& mend) {
  throw Error(what, "", mend, ExitCode::usage);
}

/// A length that must be given, in metres.
inline double required(const std::optional<double>& value, const std::string& name) {
  if (!value) refuse_usage(fmt::format("{} is needed for this type", name), "give it in metres");
  if (!(std::isfinite(*value) && *value >= 0))
    refuse_usage(fmt::format("{} is {} m", name, *value), "give a positive length");
  plausibility::require(plausibility::kOffset, *value, name, "", ExitCode::usage);
  return *value;
}

/// Names of the types with an articulated plate for which `is` holds, with spaces between.
template <class Is>
[[nodiscard]] std::string types_where(const Is& is) {
  std::string names;
  for_each_robot_type([&](auto type) {
    using R = decltype(type);
    if constexpr (R::kPlateTurns) {
      if (is(type) && !has_word(names, R::kName)) names += (names.empty() ? "" : " ") + std::string(R::kName);
    }
  });
  return names;
}
inline std::string types_needing(double PlateShape::*length) {
  return types_where([length](auto type) { return std::isnan(decltype(type)::usual().*length); });
}
/// What was given of the plate.
struct PlateFlags {
  std::optional<double> spacing, bar_spacing, pinion_radius, ratio, azimuth, range;
  std::optional<std::string> tool_on;

  /// The usual plate of the type with what was given. \param limbs  azimuths, of which the first two hold half plate 1
  [[nodiscard]] PlateShape shape_for(const RobotDescription& robot, const std::vector<double>& limbs) const {
    PlateShape shape = visit_robot_type(
        robot.type, robot.drive_kind,
        [](auto type) -> PlateShape {
          using R = decltype(type);
          if constexpr (R::kPlateTurns) return R::usual();
          return {};
        },
        [] { return PlateShape(); });
    // In the middle of the first two limbs, by the shorter way.
    shape.azimuth =
        azimuth.value_or(std::atan2(std::sin(limbs[0]) + std::sin(limbs[1]), std::cos(limbs[0]) + std::cos(limbs[1])));
    const auto take = [&shape](const std::optional<double>& given, double PlateShape::*member, const char* flag) {
      if (std::isnan(shape.*member)) {
        shape.*member = required(given, flag);
      } else {
        shape.*member = given.value_or(shape.*member);
      }
    };
    take(spacing, &PlateShape::spacing, "--plate-spacing");
    take(bar_spacing, &PlateShape::bar_spacing, "--plate-bar-spacing");
    take(pinion_radius, &PlateShape::pinion_radius, "--pinion-radius");
    take(ratio, &PlateShape::ratio, "--tool-ratio");
    take(range, &PlateShape::range, "--plate-range-rad");
    const std::string tool = tool_on.value_or("centre");
    if (tool != "centre" && tool != "half_plate")
      refuse_usage(fmt::format("--tool-on {} is not known", tool), "use centre or half_plate");
    shape.tool = tool == "centre" ? ToolPlace::centre : ToolPlace::half_plate;
    return shape;
  }
};

inline void warn_of_tipping(const Robot& robot, const Eigen::Vector3d& home) {
  Eigen::VectorXd z = Eigen::VectorXd::Zero(robot.drives()), q(robot.drives());
  z.head<3>() = home;
  if (robot.description().parts.empty() || robot.inverse_kinematics(z, q) != Status::ok) return;
  if (tipping_margin(robot, q) < kLeastTippingMargin)
    fmt::print(stderr,
               "warning: in the home pose both halves of the plate may tip about the same axis, which its hinges do "
               "not stop\n  {}\n",
               kTippingMend);
}

}  // namespace deltadyn::tools
