#pragma once

/// \file
/// A pendulum on its drive as bench logs show it: moves with rests between, a coarse encoder, a noisy torque with
/// peaks, both at a few hundred Hz.

#include <cmath>
#include <numbers>
#include <random>

#include "deltadyn/runtime/random.hpp"
#include "deltadyn/signal/log.hpp"

namespace deltadyn::testing_support {

struct BenchMove {
  double inertia = 0.19, gravity = 3.6, viscous = 0.012, coulomb = 0.17;  ///< [kg m^2], m c g [N m], [N m s/rad], [N m]
  double rate_hz = 300, duration_s = 16, encoder_step = 2.9e-3;
  double torque_noise = 0.15, peak_share = 0, peak = 8;  ///< [N m]; share of the samples with a peak, and its size
  bool rests = true;
  double late_s = 0;
  double vibration_hz = 0, vibration = 0;  ///< that takes no torque [rad/s^2]
  std::uint64_t seed = 1;

  [[nodiscard]] double position(double t) const {
    const double phase = 0.9 * static_cast<double>(seed);
    if (!rests)
      return 0.75 * std::sin(2.8 * t + phase) + 0.45 * std::sin(6.6 * t + 2 * phase) + 0.18 * std::sin(13.8 * t);
    // There and back within the first half of every four seconds, rest in the second.
    const double s = std::min(1.0, std::fmod(t, 4.0) / 2.0),
                 go = s - std::sin(2 * std::numbers::pi * s) / (2 * std::numbers::pi);
    const bool away = static_cast<long>(std::floor(t / 4.0)) % 2 == 0;
    return 3 * (away ? go : 1 - go) + std::pow(std::sin(std::numbers::pi * s), 2) * 0.4 * std::sin(13.2 * t + phase);
  }

  [[nodiscard]] double torque(double t) const {
    const double h = 1e-4, q = position(t), v = (position(t + h) - position(t - h)) / (2 * h);
    const double a = (position(t + h) - 2 * q + position(t - h)) / (h * h);
    return inertia * a - gravity * std::cos(q) + viscous * v + coulomb * std::tanh(v / 0.01);
  }

  [[nodiscard]] Log make() const {
    std::mt19937_64 random(seed);
    NormalDistribution normal;
    UniformDistribution uniform;
    Log log;
    log.file = "bench";
    const auto N = static_cast<Eigen::Index>(duration_s * rate_hz);
    log.t_s = Eigen::VectorXd::LinSpaced(N, 0.0, static_cast<double>(N - 1) / rate_hz);
    log.q.resize(N, 1);
    log.tau.resize(N, 1);
    const double omega = 2 * std::numbers::pi * vibration_hz;
    for (Eigen::Index k = 0; k < N; ++k) {
      const double t = log.t_s(k), shake = vibration_hz > 0 ? vibration / (omega * omega) * std::sin(omega * t) : 0.0;
      log.q(k, 0) = encoder_step * std::round((position(t) + shake) / encoder_step);
      log.tau(k, 0) = torque(t - late_s) + torque_noise * normal(random);
      if (uniform(random) < peak_share) log.tau(k, 0) += peak * normal(random);
    }
    return log;
  }
};

}  // namespace deltadyn::testing_support
