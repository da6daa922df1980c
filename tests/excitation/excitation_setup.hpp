#pragma once

/// \file
/// Robots with limits, for the tests of the excitation.

#include <memory>
#include <string>
#include <vector>

#include "deltadyn/excitation/design_space.hpp"
#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/runtime/workspace.hpp"

#include "support/descriptions.hpp"

namespace deltadyn::testing_support {

/// A robot, its limits and the design space between them. The space points to the robot: do not move it away.
struct ExcitationSetup {
  std::unique_ptr<Robot> robot;
  std::unique_ptr<MotionLimits> limits;
  DesignSpace space;
};

inline Region half_ball(double radius = 0.35) {
  Region region;
  region.shape = RegionShape::half_ball;
  region.centre = Eigen::Vector3d(0, 0, -0.80);
  region.radius = radius;
  return region;
}

/// The limits of the delta4, as far as a robot has such drives and coordinates.
inline MotionLimits usual_limits(const Robot& robot) {
  const RobotDescription& description = robot.description();
  MotionLimits limits(description);
  const bool linear = description.drive_kind == DriveKind::prismatic;
  for (int i = 0; i < description.drives(); ++i) {
    const bool yaw = i == 3;
    limits.qd(i) = yaw ? 48 : (linear ? 3 : 6);
    limits.qdd(i) = yaw ? 240 : (linear ? 30 : 60);
    limits.q_lower(i) = yaw ? -40 : (linear ? -0.5 : -0.9);
    limits.q_upper(i) = yaw ? 40 : (linear ? 1.5 : 1.6);
  }
  if (description.parts.empty()) return limits;
  for (int i = 0; i < 3; ++i) {
    limits.zd(i) = 4;
    limits.zdd(i) = 50;
  }
  if (description.drives() > 3) {
    limits.zd(3) = 48;
    limits.zdd(3) = 240;
  }
  if (description.type == "delta4") {
    limits.region = half_ball();
  } else {
    const WorkspaceBall ball = WorkspaceSampler(robot).ball();
    Region region;
    region.centre = ball.centre;
    region.radius = ball.radius;
    limits.region = region;
  }
  return limits;
}

/// delta3, linear-delta3, delta4 or axis.
inline ExcitationSetup excitation_setup(const std::string& type, int states = 1000) {
  ExcitationSetup setup;
  const RobotDescription description = type == "axis" ? axis_description(DriveKind::revolute) : delta_description(type);
  setup.robot = make_robot(description);
  setup.limits = std::make_unique<MotionLimits>(usual_limits(*setup.robot));
  Eigen::VectorXd scale = Eigen::VectorXd::Constant(description.drives(), 60);
  if (description.drives() > 3) scale(3) = 4;
  setup.space =
      make_design_space(*setup.robot, *setup.limits, find_base_parameters(*setup.robot).independent, scale, states, 1);
  return setup;
}

}  // namespace deltadyn::testing_support
