#pragma once

/// \file
/// Logs of one drive of known inertia and friction, for what concerns a single joint.

#include <random>

#include "deltadyn/runtime/random.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/signal/log.hpp"

#include "signal/multi_sine.hpp"

namespace deltadyn::testing_support {

struct AxisLog {
  double inertia = 0.4, viscous = 0.8, coulomb = 1.5;  ///< [kg m^2], [N m s/rad], [N m]
  double presliding = 0;                               ///< displacement of the bristle [rad]; 0: Coulomb's law
  double bristle_damping_s = 0;                        ///< T of F = Fc (z + T dz/dt)
  double ripple = 0, waves = 31;                       ///< [N m], a turn
  double torque_noise = 0.05;
  int encoder_bits = 19;
  double base_hz = 0.37, amplitude = 0.6, duration_s = 10, rate_hz = 1000;
  std::uint64_t seed = 1;

  /// The friction's state is integrated here in steps a tenth of a sample: it shares no code with the library.
  [[nodiscard]] Log make() const {
    std::mt19937_64 random(seed);
    NormalDistribution normal;
    const testing_support::MultiSine motion{base_hz, amplitude};
    const double phase = 0.7 * static_cast<double>(seed);
    Log log;
    log.file = "axis";
    log.t_s = testing_support::times(rate_hz, static_cast<Eigen::Index>(duration_s * rate_hz));
    const Eigen::VectorXd v = motion.at(log.t_s, 1, phase);
    log.q = testing_support::quantised(motion.at(log.t_s, 0, phase), encoder_bits);
    log.tau = inertia * motion.at(log.t_s, 2, phase) + viscous * v;
    constexpr int kSteps = 10;
    double z = v(0) > 0 ? 1 : -1;
    const Eigen::VectorXd q = motion.at(log.t_s, 0, phase);
    for (Eigen::Index k = 0; k < log.samples(); ++k) {
      log.tau(k, 0) += ripple * std::cos(waves * q(k) + 0.4);
      if (presliding > 0) {
        const double next = v(std::min(k + 1, log.samples() - 1));
        const double bristle_rate = (v(k) - std::abs(v(k)) * z) / presliding;
        log.tau(k, 0) += coulomb * (z + bristle_damping_s * bristle_rate) + torque_noise * normal(random);
        for (int i = 0; i < kSteps; ++i) {
          const double rate = v(k) + (next - v(k)) * (i + 0.5) / kSteps;
          z += (rate - std::abs(rate) * z) / presliding / (kSteps * rate_hz);
        }
      } else {
        log.tau(k, 0) += coulomb * (v(k) > 0 ? 1 : -1) + torque_noise * normal(random);
      }
    }
    return log;
  }
};

}  // namespace deltadyn::testing_support
