#include "deltadyn/trajectory/limit_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace deltadyn {

using Eigen::Index;

double LimitCheck::margin() const {
  if (!reachable) return -1;
  return uses.empty() ? 1 : 1 - tightest().load;
}

const LimitUse& LimitCheck::tightest() const {
  return *std::ranges::max_element(uses, {}, &LimitUse::load);
}

void LimitCheck::merge(const LimitCheck& other, double starts_at_s) {
  reachable = reachable && other.reachable;
  if (uses.empty()) uses.resize(other.uses.size());
  for (std::size_t k = 0; k < std::min(uses.size(), other.uses.size()); ++k) {
    if (!uses[k].limit.name.empty() && uses[k].load >= other.uses[k].load) continue;
    uses[k] = other.uses[k];
    uses[k].time_s += starts_at_s;
  }
}

LimitCheck check_limits(const Robot& robot, const MotionLimits& limits, const SmoothMotion& motion, int samples) {
  const int n = robot.drives();
  LimitCheck check;
  for (const Limit& limit : limits.list(robot.description())) check.uses.push_back({limit, -1, 0, 0});
  const auto count = static_cast<Index>(check.uses.size());
  Eigen::MatrixXd usage(count, samples + 1), values(count, samples + 1);
  // Coulomb friction jumps where a joint turns back, be it for a moment between two samples. It counts in full,
  // whichever way the joint turns, on the side of the rest of the torque, which is smooth in time: at a reversal both
  // signs occur anyway.
  const bool torque = limits.parameters.size() > 0;
  const std::vector<Index> columns = torque ? coulomb_columns(robot) : std::vector<Index>();
  Eigen::MatrixXd Y(n, robot.parameters());
  LimitedState state;
  state.x.resize(3 * n);
  state.drives.resize(3 * n);
  state.tau.resize(n);
  Eigen::VectorXd q(n), qd(n), qdd(n), friction(n);
  const auto time_of = [&](Index i) { return motion.duration_s * static_cast<double>(i) / samples; };
  for (Index i = 0; i <= samples; ++i) {
    const TaskState task = motion.at(time_of(i));
    Status status = robot.to_drives(task, q, qd, qdd);
    if (status == Status::ok && torque) status = robot.regressor(q, qd, qdd, Y);
    if (status != Status::ok) {
      check.reachable = false;
      return check;
    }
    if (torque) {
      state.tau = Y * limits.parameters;
      friction.setZero();
      for (const Index column : columns) {
        const Eigen::VectorXd part = Y.col(column) * limits.parameters(column);
        state.tau -= part;
        friction += part.cwiseAbs();
      }
      for (int drive = 0; drive < n; ++drive) state.tau(drive) += std::copysign(friction(drive), state.tau(drive));
    }
    state.x << task.z, task.zd, task.zdd;
    state.drives << q, qd, qdd;
    for (Index k = 0; k < count; ++k) {
      const Limit& limit = check.uses[static_cast<std::size_t>(k)].limit;
      values(k, i) = limited_value(limit, limits, state);
      usage(k, i) = usage_of(limit, values(k, i));
    }
  }
  for (Index k = 0; k < count; ++k) {
    LimitUse& use = check.uses[static_cast<std::size_t>(k)];
    const auto bend = [&](Index i) {
      return i < 1 || i >= samples ? 0.0 : std::abs(usage(k, i - 1) - 2 * usage(k, i) + usage(k, i + 1));
    };
    use.load = -std::numeric_limits<double>::infinity();
    for (Index i = 0; i <= samples; ++i) {
      const double between = std::max({bend(i - 1), bend(i), bend(i + 1)}) / 4;
      const double load = limit_load(use.limit, usage(k, i)) + between;
      if (load <= use.load) continue;
      use = {use.limit, load, values(k, i), time_of(i)};
    }
  }
  return check;
}

}  // namespace deltadyn
