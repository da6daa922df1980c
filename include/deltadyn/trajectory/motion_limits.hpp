#pragma once

/// \file
/// Every limit on a motion, paper (10) and (11), as usages that must stay within one.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/trajectory/region.hpp"

namespace deltadyn {

/// What a limit is on. Task space and drives: position, velocity, acceleration.
enum class LimitedQuantity { region, z, zd, zdd, q, qd, qdd, tau };

/// "position", "velocity", ..., "workspace".
[[nodiscard]] const char* word_of(LimitedQuantity quantity);

/// Value allowed in [lower, upper]; an end may be infinite.
struct Limit {
  LimitedQuantity quantity;
  int index;  ///< of the coordinate, the drive, or the wall of the region
  double lower, upper;
  std::string name;  ///< "drive 2 velocity", "z acceleration", "workspace radius"
  std::string unit;  ///< SI; empty for a wall
};

/// The limits of one motion. Vectors have one entry a coordinate or drive; infinite entries do not limit.
struct MotionLimits {
  std::optional<Region> region;  ///< of the plate's centre; none for an axis
  Eigen::VectorXd z_lower, z_upper, zd, zdd;
  Eigen::VectorXd q_lower, q_upper, qd, qdd;
  Eigen::VectorXd tau;         ///< needs `parameters`
  Eigen::VectorXd parameters;  ///< prior model, as Robot::parameter_names(); empty: torque is not limited

  /// Those of the robot file; nothing in task space.
  explicit MotionLimits(const RobotDescription& robot);
  /// Those of one drive, as a robot file has them.
  [[nodiscard]] DriveLimits of_drive(int drive) const;
  /// All rates times `share`, all accelerations times its square: the same motions, slower.
  [[nodiscard]] MotionLimits slowed(double share) const;
  /// Throws deltadyn::Error(usage) that names the limits that contradict each other, and if velocity or acceleration
  /// are not limited at all.
  void validate(const RobotDescription& robot) const;
  /// The robot file holds what the machine can do: a sentence for each drive that is asked for more. Throws
  /// deltadyn::Error(usage) if far more is asked for.
  [[nodiscard]] std::vector<std::string> beyond_file(const RobotDescription& robot) const;
  /// All finite limits.
  [[nodiscard]] std::vector<Limit> list(const RobotDescription& robot) const;
};

/// A state of motion, stacked: x = (z, zd, zdd), drives = (q, qd, qdd), and the drive torques if they are limited.
struct LimitedState {
  Eigen::VectorXd x, drives, tau;
};

/// The value that a limit is on [m, rad, ...]; for a wall of the region its Region::usage.
double limited_value(const Limit& limit, const MotionLimits& limits, const LimitedState& state);
/// Usage of a value: -1 at the lower and 1 at the upper end of the range; one-sided limits: 1 at the end, and a unit
/// from it counts as one; walls: the value itself.
double usage_of(const Limit& limit, double value);
/// d usage / d value.
double usage_slope(const Limit& limit);
/// True if both signs of the usage count.
bool two_sided(const Limit& limit);
/// |usage| of a two-sided limit, else the usage: the limit is kept while it is at most one.
double limit_load(const Limit& limit, double usage);

}  // namespace deltadyn
