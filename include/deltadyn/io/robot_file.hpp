#pragma once

/// \file
/// Robot files: the spanning tree in plain URDF, which RViz, Pinocchio and Gazebo read, and the loop closures in the
/// URDF+ extension element `<loop>` (Chignoli, Slotine, Wensing, Kim, arXiv 2411.19753), which plain URDF readers skip.
///
/// Tree of a Delta with limbs K = 1..3 and struts s = a (at +y of the limb), b (at -y):
///
///     base -driveK-> upper_armK -strutKs_y-> strutKs_knuckle -strutKs_z-> strutKs
///     strut1a -platform_z-> platform_knuckle -platform_y-> platform_mount -fixed-> platform
///     base -drive4-> telescope_yoke -telescope_x-> telescope_cross -telescope_y-> telescope_upper
///     telescope_upper -telescope-> telescope_lower -tool_y-> tool_cross -tool_x-> tool_mount -fixed-> tool
///
/// The frame of a strut is at its elbow with x along it, that of the platform at the plate's centre.
/// Loops: `strutKs_end` (spherical) for the five other strut ends, `tool_axis` (revolute about z) between platform and
/// tool. The joint `telescope` is prismatic along -z: its position is the length of the bar between the two universal
/// joints. An axis is `base -drive1-> upper_arm1 -fixed-> upper_arm1_tip`. No passive joint follows a drive alone, so
/// that no URDF+ `<coupling>` is needed; the joints that mirror another one (platform_z, tool_x, tool_y) are plain URDF
/// `<mimic>`.
///
/// What the tree has no place for stands in an element `<deltadyn>`: type, elbow posture, acceleration limits, gravity.
/// The geometry always comes from the tree and the loops.

#include <map>
#include <string>

#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn {

/// Values by name as in a parameter file, e.g. "strut.m" or, for one limb only, "strut3.m" (paper (4), SI units, per
/// strut).
using NamedValues = std::map<std::string, double>;

/// \returns the text of the robot file. Bodies with a mass in `parameters` get an `<inertial>` element, the others
/// none.
/// Throws deltadyn::Error if the description does not validate, or a body in `parameters` has a mass that is not
/// positive.
[[nodiscard]] std::string robot_to_urdf(const RobotDescription& robot, const NamedValues& parameters = {});

/// Writes robot_to_urdf whole or not at all.
void write_robot_file(const std::string& path, const RobotDescription& robot, const NamedValues& parameters = {});

/// Reads a robot file. Throws deltadyn::Error naming the link or joint and the broken rule if the file is not
/// well-formed or the mechanism is not Delta-like: wrong axis, unequal struts, missing loop, unknown parent, wrong
/// number of limbs, ... Lengths are compared to 1e-6 m and directions to 1e-6 rad, so that files written with few
/// digits can be read.
[[nodiscard]] RobotDescription read_robot_file(const std::string& path);

/// The text of a robot file. Throws deltadyn::Error if it cannot be read.
[[nodiscard]] std::string read_robot_text(const std::string& path);

/// The same from text; `where` names the source in messages.
[[nodiscard]] RobotDescription robot_from_urdf(const std::string& text, const std::string& where);

}  // namespace deltadyn
