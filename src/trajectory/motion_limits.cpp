#include "deltadyn/trajectory/motion_limits.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <utility>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/plausibility.hpp"
#include "deltadyn/trajectory/task_columns.hpp"

namespace deltadyn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Limits of the drives and of the task by the same rules as everywhere; infinite ones do not limit.
void require_plausible(const MotionLimits& limits, const RobotDescription& robot,
                       const std::vector<TaskColumns>& columns) {
  using namespace plausibility;
  const auto bounded = [](const Rule& rule, double value, const std::string& what) {
    if (!std::isinf(value)) require(rule, value, what, "limits", ExitCode::usage);
  };
  for (int i = 0; i < robot.drives(); ++i) {
    require_limits(robot, i, limits.of_drive(i), "limits", ExitCode::usage);
    if (robot.parts.empty()) continue;  // the coordinate is the drive itself
    const TaskColumns& column = columns[static_cast<std::size_t>(i)];
    for (const double end : {limits.z_lower(i), limits.z_upper(i)})
      bounded(column.rotation ? kYaw : kOffset, end, column.name + ": a position limit");
    bounded(column.rotation ? kYawVelocity : kPlateVelocity, limits.zd(i), column.name + ": the velocity limit");
    bounded(column.rotation ? kYawAcceleration : kPlateAcceleration, limits.zdd(i),
            column.name + ": the acceleration limit");
  }
}

void require_size(const Eigen::VectorXd& v, int n, const char* what) {
  if (v.size() != n)
    throw Error(fmt::format("{} limits of the {} were given", v.size(), what), "limits", fmt::format("give {}", n),
                ExitCode::usage);
}

}  // namespace

const char* word_of(LimitedQuantity quantity) {
  static constexpr const char* kWords[] = {"workspace", "position", "velocity",     "acceleration",
                                           "position",  "velocity", "acceleration", "torque"};
  return kWords[static_cast<std::size_t>(quantity)];
}

MotionLimits::MotionLimits(const RobotDescription& robot) {
  const int n = robot.drives();
  z_lower = q_lower = Eigen::VectorXd::Constant(n, -kInfinity);
  z_upper = zd = zdd = q_upper = qd = qdd = tau = Eigen::VectorXd::Constant(n, kInfinity);
  for (int i = 0; i < n; ++i) {
    const DriveLimits& limits = robot.limits[static_cast<std::size_t>(i)];
    q_lower(i) = limits.lower;
    q_upper(i) = limits.upper;
    qd(i) = limits.velocity;
    qdd(i) = limits.acceleration;
    tau(i) = limits.effort;
  }
  if (robot.plate) {
    z_upper(n - 1) = robot.plate_yaw_range();
    z_lower(n - 1) = -z_upper(n - 1);
  }
}

DriveLimits MotionLimits::of_drive(int drive) const {
  DriveLimits limits;
  limits.lower = q_lower(drive);
  limits.upper = q_upper(drive);
  limits.velocity = qd(drive);
  limits.acceleration = qdd(drive);
  limits.effort = tau(drive);
  return limits;
}

MotionLimits MotionLimits::slowed(double share) const {
  MotionLimits slow = *this;
  slow.zd *= share;
  slow.qd *= share;
  slow.zdd *= share * share;
  slow.qdd *= share * share;
  return slow;
}

void MotionLimits::validate(const RobotDescription& robot) const {
  const int n = robot.drives();
  const auto columns = task_columns(robot);
  require_size(z_lower, n, "lower ends of the task coordinates");
  require_size(z_upper, n, "upper ends of the task coordinates");
  require_size(zd, n, "task-space velocities");
  require_size(zdd, n, "task-space accelerations");
  require_size(q_lower, n, "lower ends of the drives");
  require_size(q_upper, n, "upper ends of the drives");
  require_size(qd, n, "drive velocities");
  require_size(qdd, n, "drive accelerations");
  require_size(tau, n, "drive torques");
  if (region) region->validate();
  if (region && robot.parts.empty())
    throw Error("an axis has no workspace", "limits", "limit the range of the drive instead", ExitCode::usage);
  const auto contradiction = [](const std::string& what, double lower, double upper) {
    throw Error(fmt::format("the limits of the {} contradict each other: lower end {:.6g}, upper end {:.6g}", what,
                            lower, upper),
                "limits", "give a lower end below the upper end", ExitCode::usage);
  };
  const auto positive = [](const std::string& what, double value) {
    if (!(value > 0))
      throw Error(fmt::format("the {} limit is {:.6g}, so nothing may move", what, value), "limits",
                  "give a positive limit", ExitCode::usage);
  };
  for (int i = 0; i < n; ++i) {
    const std::string drive = fmt::format("drive {}", i + 1), &task = columns[static_cast<std::size_t>(i)].name;
    if (!(z_lower(i) < z_upper(i))) contradiction(task + " position", z_lower(i), z_upper(i));
    if (!(q_lower(i) < q_upper(i))) contradiction(drive + " position", q_lower(i), q_upper(i));
    positive(task + " velocity", zd(i));
    positive(task + " acceleration", zdd(i));
    positive(drive + " velocity", qd(i));
    positive(drive + " acceleration", qdd(i));
    positive(drive + " torque", tau(i));
    const bool turns = robot.kind_of_drive(i) == DriveKind::revolute;
    const auto unlimited = [&](const char* what, const char* flag_of_turning, const char* flag_of_sliding) {
      throw Error(fmt::format("neither {} nor drive {} has a limit of its {}", task, i + 1, what), "limits",
                  fmt::format("give the {} limit of the drives in the robot file (delta-model create) or by {}", what,
                              turns ? flag_of_turning : flag_of_sliding),
                  ExitCode::usage);
    };
    if (!std::isfinite(zd(i)) && !std::isfinite(qd(i)))
      unlimited("velocity", "--drive-velocity-rad-s", "--drive-velocity-m-s");
    if (!std::isfinite(zdd(i)) && !std::isfinite(qdd(i)))
      unlimited("acceleration", "--drive-acceleration-rad-s2", "--drive-acceleration-m-s2");
    const bool inside_region = region && i < 3;
    if (!inside_region && !(std::isfinite(z_lower(i)) && std::isfinite(z_upper(i))) &&
        !(std::isfinite(q_lower(i)) && std::isfinite(q_upper(i))))
      unlimited("position range", "--drive-range-rad", "--drive-range-m");
  }
  require_plausible(*this, robot, columns);
  if (region) {
    const char axes[] = "xyz";
    for (int i = 0; i < 3; ++i) {
      if (region->lower()(i) >= z_upper(i) || region->upper()(i) <= z_lower(i))
        throw Error(fmt::format("the {} range [{:.6g}, {:.6g}] m has nothing in common with the workspace ({})",
                                axes[i], z_lower(i), z_upper(i), region->text()),
                    "limits", "move the workspace or widen the range", ExitCode::usage);
    }
  }
}

std::vector<std::string> MotionLimits::beyond_file(const RobotDescription& robot) const {
  std::vector<std::string> told;
  for (int i = 0; i < robot.drives(); ++i) {
    std::string beyond = plausibility::compare_limits(robot, i, of_drive(i), "limits");
    if (!beyond.empty()) told.push_back(std::move(beyond));
  }
  return told;
}

std::vector<Limit> MotionLimits::list(const RobotDescription& robot) const {
  std::vector<Limit> limits;
  if (region) {
    for (int wall = 0; wall < region->walls(); ++wall)
      limits.push_back({LimitedQuantity::region, wall, -kInfinity, 1.0, region->wall_name(wall), ""});
  }
  const auto columns = task_columns(robot);
  const auto add = [&](LimitedQuantity quantity, int i, double lower, double upper, const std::string& subject,
                       const std::string& unit) {
    if (!std::isfinite(lower) && !std::isfinite(upper)) return;
    limits.push_back({quantity, i, lower, upper, subject + " " + word_of(quantity), unit});
  };
  for (int i = 0; i < robot.drives(); ++i) {
    const TaskColumns& column = columns[static_cast<std::size_t>(i)];
    const std::string unit = column.rotation ? "rad" : "m";
    const bool turns = robot.kind_of_drive(i) == DriveKind::revolute;
    const std::string drive = fmt::format("drive {}", i + 1), drive_unit = turns ? "rad" : "m";
    add(LimitedQuantity::z, i, z_lower(i), z_upper(i), column.name, unit);
    add(LimitedQuantity::zd, i, -zd(i), zd(i), column.name, unit + "/s");
    add(LimitedQuantity::zdd, i, -zdd(i), zdd(i), column.name, unit + "/s^2");
    add(LimitedQuantity::q, i, q_lower(i), q_upper(i), drive, drive_unit);
    add(LimitedQuantity::qd, i, -qd(i), qd(i), drive, drive_unit + "/s");
    add(LimitedQuantity::qdd, i, -qdd(i), qdd(i), drive, drive_unit + "/s^2");
    if (parameters.size() > 0) add(LimitedQuantity::tau, i, -tau(i), tau(i), drive, turns ? "N m" : "N");
  }
  return limits;
}

double limited_value(const Limit& limit, const MotionLimits& limits, const LimitedState& state) {
  const Eigen::Index n = state.x.size() / 3;
  switch (limit.quantity) {
    case LimitedQuantity::region: return limits.region->usage(limit.index, state.x.head<3>());
    case LimitedQuantity::z: return state.x(limit.index);
    case LimitedQuantity::zd: return state.x(n + limit.index);
    case LimitedQuantity::zdd: return state.x(2 * n + limit.index);
    case LimitedQuantity::q: return state.drives(limit.index);
    case LimitedQuantity::qd: return state.drives(n + limit.index);
    case LimitedQuantity::qdd: return state.drives(2 * n + limit.index);
    case LimitedQuantity::tau: return state.tau(limit.index);
  }
  return 0;
}

double usage_slope(const Limit& limit) {
  if (limit.quantity == LimitedQuantity::region || !std::isfinite(limit.lower)) return 1.0;
  return std::isfinite(limit.upper) ? 2 / (limit.upper - limit.lower) : -1.0;
}

double usage_of(const Limit& limit, double value) {
  if (limit.quantity == LimitedQuantity::region) return value;
  if (!std::isfinite(limit.lower)) return 1 + (value - limit.upper);
  if (!std::isfinite(limit.upper)) return 1 - (value - limit.lower);
  return (2 * value - (limit.upper + limit.lower)) / (limit.upper - limit.lower);
}

bool two_sided(const Limit& limit) {
  return limit.quantity != LimitedQuantity::region && std::isfinite(limit.lower) && std::isfinite(limit.upper);
}

double limit_load(const Limit& limit, double usage) {
  return two_sided(limit) ? std::abs(usage) : usage;
}

}  // namespace deltadyn
