#include "deltadyn/io/adopt.hpp"

#include <cmath>
#include <fmt/format.h>

#include "deltadyn/model/body.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/plausibility.hpp"

#include "adopt_parts.hpp"
#include "robot_file_format.hpp"

namespace deltadyn {
namespace {

void require_unit(double value, const char* flag) {
  if (!(std::isfinite(value) && value > 0))
    throw Error(fmt::format("{} is {}", flag, value), "", "give a known unit", ExitCode::usage);
}

/// The file's units to SI. Angles are radians in every URDF.
void to_si(robot_file::UrdfTree& tree, double metre, double kilogram) {
  for (robot_file::Joint& joint : tree.joints) {
    joint.X_PJ.translation() *= metre;
    if (!joint.prismatic) continue;
    joint.limits.lower *= metre;
    joint.limits.upper *= metre;
    joint.limits.velocity *= metre;
  }
  for (auto& [name, link] : tree.links) link.X_BL.translation() *= metre;
  for (robot_file::Loop& loop : tree.loops) {
    loop.predecessor.X_LO.translation() *= metre;
    loop.successor.X_LO.translation() *= metre;
  }
  for (auto& [name, inertial] : tree.inertials) {
    inertial.mass *= kilogram;
    inertial.X_LC.translation() *= metre;
    inertial.I_C *= kilogram * metre * metre;
  }
}

void require_masses(const AdoptedRobot& adopted, const std::string& where) {
  for (const Body body :
       {Body::upper_arm, Body::strut, Body::platform, Body::tool, Body::telescope_upper, Body::telescope_lower}) {
    const std::string part = name(body);
    const InertialVector<double> p = robot_file::body_of(adopted.parameters, part);
    plausibility::require_body(adopted.robot, body, p, part, where);
  }
}

}  // namespace

AdoptedRobot adopt_robot(const std::string& text, const std::string& where, const AdoptOptions& options) {
  require_unit(options.length_unit, "--length-unit");
  require_unit(options.mass_unit, "--mass-unit");
  for (const auto& [flag, length] : {std::pair{"--strut", options.strut},
                                     {"--strut-spacing", options.strut_spacing},
                                     {"--platform-radius", options.platform_radius}})
    if (length) plausibility::require(plausibility::kLength, *length, flag, "", ExitCode::usage);
  if (options.gravity_size)
    plausibility::require(plausibility::kGravity, *options.gravity_size, "--gravity-m-s2", "", ExitCode::usage);
  robot_file::UrdfTree tree = robot_file::parse_urdf_tree(text, where, robot_file::UrdfDialect::cad);
  to_si(tree, options.length_unit, options.mass_unit);
  robot_file::require_metres(tree);
  const cad::Parts parts = cad::find_parts(tree, options);
  cad::Placed placed = cad::place_parts(tree, parts, options);
  cad::add_masses(tree, parts, placed);
  AdoptedRobot& adopted = placed;
  require_masses(adopted, where);
  return adopted;
}

}  // namespace deltadyn
