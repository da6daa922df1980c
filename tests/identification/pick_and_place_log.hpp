#pragma once

/// \file
/// Logs of a robot at its work: quick moves from point to point with stops in between, where static friction takes any
/// value.

#include <algorithm>
#include <cmath>
#include <random>

#include "deltadyn/runtime/random.hpp"

#include "identification/synthetic_log.hpp"

namespace deltadyn::testing_support {

struct PickAndPlace {
  double move_s = 0.35, stop_s = 0.25;  ///< of one move, of one stop
  double first_stop_s = 0;              ///< the log begins at rest
  double reach = 0.6;                   ///< of the workspace's radius
};

/// Moves of minimum jerk between random points. At rest each drive's Coulomb friction holds a share of its load that is
/// drawn anew.
inline Log pick_and_place_log(const Robot& robot, const Eigen::VectorXd& p, const SyntheticOptions& options,
                              const PickAndPlace& work = {}) {
  const int n = robot.drives();
  std::mt19937_64 random(options.seed);
  NormalDistribution normal;
  UniformDistribution uniform(-1, 1);
  const WorkspaceSampler sampler(robot);
  const auto point = [&] {
    Eigen::VectorXd z(n);
    for (int i = 0; i < n; ++i)
      z(i) = i < 3 ? work.reach * sampler.ball().radius / std::sqrt(3.0) * uniform(random) : 1.5 * uniform(random);
    z.head<3>() += sampler.ball().centre;
    return z;
  };
  Eigen::VectorXd without_coulomb = p, coulomb = Eigen::VectorXd::Zero(n);
  for (int k = 0; k < robot.parameters(); ++k) {
    const std::string& name = robot.parameter_names()[static_cast<std::size_t>(k)];
    if (name.rfind("drive", 0) != 0 || name.find(".coulomb") == std::string::npos) continue;
    coulomb(name[5] - '1') = p(k);
    without_coulomb(k) = 0;
  }
  const auto N = static_cast<Eigen::Index>(options.duration_s * options.rate_hz);
  Log log;
  log.file = "pick-and-place";
  log.t_s = Eigen::VectorXd::LinSpaced(N, 0.0, static_cast<double>(N - 1) / options.rate_hz);
  log.q.resize(N, n);
  log.tau.resize(N, n);
  Eigen::VectorXd from = point(), to = point(), held(n), q(n), qd(n), qdd(n), tau(n);
  double start = work.first_stop_s;
  const auto hold = [&] {
    for (int j = 0; j < n; ++j) held(j) = uniform(random);
  };
  hold();
  for (Eigen::Index k = 0; k < N; ++k) {
    if (log.t_s(k) > start + work.move_s + work.stop_s) {
      start += work.move_s + work.stop_s;
      from = to;
      to = point();
      hold();
    }
    const double s = std::clamp((log.t_s(k) - start) / work.move_s, 0.0, 1.0), T = work.move_s;
    const TaskState task{from + (to - from) * (s * s * s * (10 - 15 * s + 6 * s * s)),
                         (to - from) * (30 * s * s * (1 - s) * (1 - s) / T),
                         (to - from) * (60 * s * (1 - s) * (1 - 2 * s) / (T * T))};
    if (robot.to_drives(task, q, qd, qdd) != Status::ok) break;
    if (robot.inverse_dynamics(q, qd, qdd, without_coulomb, tau) != Status::ok) break;
    for (int j = 0; j < n; ++j) {
      const bool rests = s <= 0 || s >= 1;
      tau(j) += coulomb(j) * (rests ? held(j) : (qd(j) > 0 ? 1 : -1));
      tau(j) += options.torque_noise * (j < 3 ? 1.0 : 0.1) * normal(random);
    }
    log.q.row(k) = q;
    log.tau.row(k) = tau;
  }
  if (options.encoder_step > 0) log.q = options.encoder_step * (log.q / options.encoder_step).array().round().matrix();
  return log;
}

}  // namespace deltadyn::testing_support
