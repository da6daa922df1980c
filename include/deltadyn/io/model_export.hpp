#pragma once

/// \file
/// An identified robot in the formats of others: MJCF for MuJoCo, URDF for Pinocchio, Gazebo and RViz, a C++ header for
/// firmware.
///
/// What a format can hold travels along; what it cannot is listed, in the file as a comment and in
/// ExportedModel::left_out, so that nobody takes the export for more than it is.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "deltadyn/runtime/effect_catalogue.hpp"
#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

struct ExportedModel {
  std::string text;                   ///< of the file
  std::vector<std::string> left_out;  ///< one line each: what, where, and why
  int effects = 0;                    ///< that the file holds as effects; those that became parameters do not count
};

/// MJCF: the tree of the robot file with its loops closed by `connect` constraints, as many as the mechanism has to
/// lose and no more: six struts hold a plate with six degrees of freedom; with a telescope bar the plate hangs on the
/// tool's bearing at the bar's end. Assembled in the home pose; joint positions are ours (0 is horizontal outwards,
/// positive turns the arm down). Viscous and Coulomb friction, rotor inertias (armature) and torque offsets (bias of
/// the motors) travel along. Constraints in MuJoCo are slightly soft; the settings written are the stiffest it offers.
/// \param p  as Robot::parameter_names(); throws Error if a body is not physically consistent
[[nodiscard]] ExportedModel export_mjcf(const Robot& robot, const Eigen::VectorXd& p,
                                        const std::vector<Effect>& effects = {});

/// URDF with identified inertias and joint friction; loops as URDF+ <loop> elements (see robot_file.hpp), so that it is
/// a robot file again. Rotor inertias go into the bodies on the drive's axis, as thin rings about it: exact for drives
/// fixed on the base.
[[nodiscard]] ExportedModel export_urdf(const Robot& robot, const Eigen::VectorXd& p,
                                        const std::vector<Effect>& effects = {});

/// A C++17 header with geometry and parameters as constants, for firmware/feed_forward.hpp; with effects that a
/// controller can feed forward, a table of them, too, for firmware/effect_feed_forward.hpp.
[[nodiscard]] ExportedModel export_header(const Robot& robot, const Eigen::VectorXd& p,
                                          const std::vector<Effect>& effects = {});

}  // namespace deltadyn
