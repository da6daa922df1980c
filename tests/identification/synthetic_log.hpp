#pragma once

/// \file
/// Logs of a robot whose parameters are known: a smooth random motion in task space, torque by inverse dynamics.

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "deltadyn/runtime/random.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/runtime/workspace.hpp"
#include "deltadyn/signal/log.hpp"

#include "support/descriptions.hpp"

namespace deltadyn::testing_support {

/// Slender, consistent bodies of a real robot's size; friction of either kind in every joint.
inline Eigen::VectorXd delta_truth(const Robot& robot) {
  const auto body = [](const std::string& name) -> std::vector<double> {
    if (name.rfind("upper_arm", 0) == 0) return {1.1, 0.09, 0, 0.009, 0.012, 0.189, 0.181, 0, 0, 0};
    if (name.rfind("strut", 0) == 0) return {0.28, 0.1, 0, 0, 0.02, 0.114, 0.116, 0, 0, 0};
    if (name == "platform") return {1.2, 0, 0, 0, 0.004, 0.004, 0.006, 0, 0, 0};
    if (name.rfind("half_plate", 0) == 0) return {0.5, 0.01, 0, 0, 0.002, 0.001, 0.0025, 0, 0, 0};
    if (name == "crossbar") return {0.2, 0.004, 0.001, 0, 4e-4, 8e-4, 9e-4, 0, 0, 0};
    if (name == "tool") return {0.4, 0, 0, -0.02, 0.003, 0.003, 0.0029, 0, 0, 0};
    if (name == "telescope_upper") return {0.73, 0, 0, -0.305, 0.148, 0.148, 4e-5, 0, 0, 0};
    return {0.48, 0, 0, 0.24, 0.126, 0.126, 3e-5, 0, 0, 0};
  };
  Eigen::VectorXd p(robot.parameters());
  for (int k = 0; k < robot.parameters(); ++k) {
    const std::string& name = robot.parameter_names()[static_cast<std::size_t>(k)];
    const auto dot = name.find('.');
    const std::string owner = name.substr(0, dot);
    const bool small = owner == "drive4" && robot.description().telescope.has_value();
    if (name.find("viscous") != std::string::npos) {
      p(k) = owner == "telescope" ? 4.0 : owner == "plate" ? 0.03 : (small ? 0.02 : 1.5);
    } else if (name.find("coulomb") != std::string::npos) {
      p(k) = owner == "telescope" ? 5.0 : owner == "plate" ? 0.15 : (small ? 0.8 : 4.6);
    } else {
      p(k) = body(owner)[static_cast<std::size_t>(k % 10)];
    }
  }
  return p;
}

struct SyntheticOptions {
  double duration_s = 4.0, rate_hz = 1000.0;
  double base_frequency_hz = 0.25;
  double torque_noise = 0.0;  ///< of the limbs' drives; a tenth of it on a telescope's [N m]
  double encoder_step = 0.0;  ///< quantisation of q [rad]
  bool with_derivatives = true;
  std::uint64_t seed = 1;
};

/// A recording with noise and encoders of 12 bits.
inline SyntheticOptions coarse_recording(std::uint64_t seed) {
  SyntheticOptions out;
  out.duration_s = 10;
  out.torque_noise = 0.1;
  out.base_frequency_hz = 0.3;
  out.encoder_step = 2 * std::numbers::pi / 4096;
  out.with_derivatives = false;
  out.seed = seed;
  return out;
}

/// Fourier motion around the middle of the workspace. Exact q, qd, qdd unless quantised.
inline Log synthetic_log(const Robot& robot, const Eigen::VectorXd& p, const SyntheticOptions& options) {
  const int n = robot.drives();
  std::mt19937_64 random(options.seed);
  NormalDistribution normal;
  const WorkspaceSampler sampler(robot);
  constexpr int kHarmonics = 5;
  Eigen::MatrixXd a(n, kHarmonics), b(n, kHarmonics);
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < kHarmonics; ++k) {
      const double yaw = robot.description().plate ? 0.15 * robot.description().plate_yaw_range() : 1.0;
      const double size = (i < 3 ? 0.3 * sampler.ball().radius : yaw) / (k + 1);
      a(i, k) = size * normal(random);
      b(i, k) = size * normal(random);
    }
  }
  const auto N = static_cast<Eigen::Index>(options.duration_s * options.rate_hz);
  Log log;
  log.file = "synthetic";
  log.t_s = Eigen::VectorXd::LinSpaced(N, 0.0, static_cast<double>(N - 1) / options.rate_hz);
  log.q.resize(N, n);
  log.qd.resize(N, n);
  log.qdd.resize(N, n);
  log.tau.resize(N, n);
  Eigen::VectorXd q(n), qd(n), qdd(n), tau(n);
  double scale = 1.0;
  for (Eigen::Index k = 0; k < N;) {
    TaskState task{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
    for (int h = 0; h < kHarmonics; ++h) {
      const double omega = 2 * std::numbers::pi * options.base_frequency_hz * (h + 1);
      const double s = std::sin(omega * log.t_s(k)), c = std::cos(omega * log.t_s(k));
      task.z += scale * (a.col(h) * s + b.col(h) * c);
      task.zd += scale * omega * (a.col(h) * c - b.col(h) * s);
      task.zdd -= scale * omega * omega * (a.col(h) * s + b.col(h) * c);
    }
    task.z.head<3>() += sampler.ball().centre;
    if (robot.to_drives(task, q, qd, qdd) != Status::ok || task.z.head<3>().norm() < 0.3) {
      scale *= 0.8;  // out of reach: begin again with a smaller motion
      if (scale < 1e-3) throw std::runtime_error("the home pose of this robot lies too near to the origin");
      k = 0;
      continue;
    }
    if (robot.inverse_dynamics(q, qd, qdd, p, tau) != Status::ok) break;
    log.q.row(k) = q;
    log.qd.row(k) = qd;
    log.qdd.row(k) = qdd;
    for (int j = 0; j < n; ++j) {
      const bool of_a_limb = j < static_cast<int>(robot.description().limbs.size());
      tau(j) += options.torque_noise * (of_a_limb ? 1.0 : 0.1) * normal(random);
    }
    log.tau.row(k) = tau;
    ++k;
  }
  if (options.encoder_step > 0) log.q = options.encoder_step * (log.q / options.encoder_step).array().round().matrix();
  if (!options.with_derivatives) {
    log.qd.resize(0, 0);
    log.qdd.resize(0, 0);
  }
  return log;
}

}  // namespace deltadyn::testing_support
