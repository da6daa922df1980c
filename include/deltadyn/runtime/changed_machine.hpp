#pragma once

/// \file
/// A robot with the changes that effects make of a machine: the Machine of effects/kinds.hpp.

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "deltadyn/core/rotation.hpp"
#include "deltadyn/effects/kinds.hpp"
#include "deltadyn/model/inertial_parameters.hpp"
#include "deltadyn/runtime/parameter_id.hpp"
#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn {

struct ChangedMachine {
  RobotDescription description;
  /// True drive coordinate minus the one that the encoder knows
  Eigen::VectorXd home_offset;
  std::vector<std::pair<ParameterId, double>> parameters;  ///< what is added to parameters, each limb with its own
  std::vector<std::pair<int, SpringInDrive>> springs;      ///< by drive from 0

  explicit ChangedMachine(const RobotDescription& robot)
      : description(robot), home_offset(Eigen::VectorXd::Zero(robot.drives())) {}

  void tilt(double x, double y) { description.gravity += skew(Vector3<double>(x, y, 0.0)) * description.gravity; }
  void shift_home(int drive, double by) { home_offset(drive) += by; }
  /// A carriage has no arm: an error of its place along the axis, which a length would be, is one of its home position.
  void lengthen_arm(int limb, double by) {
    if (description.drive_kind == DriveKind::revolute) {
      description.limbs.at(static_cast<std::size_t>(limb)).p_DE_0.x() += by;
    } else {
      shift_home(limb, by);
    }
  }
  void lengthen_strut(int limb, double by) { description.limbs.at(static_cast<std::size_t>(limb)).strut += by; }
  void add_to_arm(int limb, double moment, double inertia) {
    parameters.push_back({{ParameterKind::inertial, limb + 1, Body::upper_arm, inertial::kMcx}, moment});
    parameters.push_back({{ParameterKind::inertial, limb + 1, Body::upper_arm, inertial::kIyy}, inertia});
  }
  void add_rotor(int drive, double inertia) {
    parameters.push_back({{ParameterKind::rotor_inertia, drive + 1}, inertia});
  }
  /// Of an articulated plate the tool carries the load.
  void add_to_plate(double mass) {
    parameters.push_back({{ParameterKind::inertial, 0, description.plate ? Body::tool : Body::platform}, mass});
  }
  void soften(int drive, const SpringInDrive& spring) { springs.emplace_back(drive, spring); }
};

}  // namespace deltadyn
