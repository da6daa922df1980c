#include "deltadyn/trajectory/limit_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace deltadyn {

using Eigen::Index;

namespace {

/// The parameters without Coulomb friction, whose torque is smooth in time.
Eigen::VectorXd smooth_part(const Robot& robot, const Eigen::VectorXd& parameters) {
  Eigen::VectorXd smooth = parameters;
  const std::vector<std::string>& names = robot.parameter_names();
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k].ends_with(".coulomb")) smooth(static_cast<Index>(k)) = 0;
  return smooth;
}

}  // namespace

double LimitCheck::margin() const {
  if (!reachable) return -1;
  return uses.empty() ? 1 : 1 - tightest().load;
}

const LimitUse& LimitCheck::tightest() const {
  return *std::max_element(uses.begin(), uses.end(), [](const LimitUse& a, const LimitUse& b) { return a.load < b.load; });
}

void LimitCheck::merge(const LimitCheck& other, double starts_at_s) {
  if (!other.reachable && reachable) {
    reachable = false;
    unreachable_at_s = other.unreachable_at_s + starts_at_s;
  }
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
  // What jumps in a torque, when a joint turns back, is kept apart: it has no bend, but may last up to the next sample.
  Eigen::MatrixXd jumping = Eigen::MatrixXd::Zero(count, samples + 1);
  LimitedState state;
  state.x.resize(3 * n);
  state.drives.resize(3 * n);
  state.tau.resize(n);
  Eigen::VectorXd q(n), qd(n), qdd(n);
  const bool torque = limits.parameters.size() > 0;
  const Eigen::VectorXd smooth = torque ? smooth_part(robot, limits.parameters) : Eigen::VectorXd();
  Eigen::VectorXd smooth_tau(n);
  const auto time_of = [&](Index i) { return motion.duration_s * static_cast<double>(i) / samples; };
  for (Index i = 0; i <= samples; ++i) {
    const TaskState task = motion.at(time_of(i));
    Status status = robot.to_drives(task, q, qd, qdd);
    if (status == Status::ok && torque) status = robot.inverse_dynamics(q, qd, qdd, limits.parameters, state.tau);
    if (status == Status::ok && torque) status = robot.inverse_dynamics(q, qd, qdd, smooth, smooth_tau);
    if (status != Status::ok) {
      check.reachable = false;
      check.unreachable_at_s = time_of(i);
      return check;
    }
    state.x << task.z, task.zd, task.zdd;
    state.drives << q, qd, qdd;
    for (Index k = 0; k < count; ++k) {
      const Limit& limit = check.uses[static_cast<std::size_t>(k)].limit;
      values(k, i) = limited_value(limit, limits, state);
      usage(k, i) = usage_of(limit, values(k, i));
      if (limit.quantity != LimitedQuantity::tau) continue;
      jumping(k, i) = usage_slope(limit) * (state.tau(limit.index) - smooth_tau(limit.index));
      usage(k, i) -= jumping(k, i);
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
      const Index first = std::max<Index>(i - 1, 0), near = std::min<Index>(i + 1, samples) - first + 1;
      const auto jumps = jumping.row(k).segment(first, near);
      const double load =
          std::max(limit_load(use.limit, usage(k, i) + jumps.maxCoeff()), limit_load(use.limit, usage(k, i) + jumps.minCoeff())) +
          between;
      if (load <= use.load) continue;
      use = {use.limit, load, values(k, i), time_of(i)};
    }
  }
  return check;
}

}  // namespace deltadyn
