#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace deltadyn::testing_support {

/// A drive motion with known derivatives: five harmonics of a base frequency, as an encoder of `bits` a turn sees it.
struct MultiSine {
  double base_hz = 0.5;
  double amplitude = 0.3;

  [[nodiscard]] Eigen::VectorXd at(const Eigen::VectorXd& t_s, int derivative, double phase = 0.0) const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(t_s.size());
    for (int k = 1; k <= 5; ++k) {
      const double omega = 2 * std::numbers::pi * base_hz * k;
      const double advance = 0.5 * std::numbers::pi * derivative + phase + 1.3 * k * k;
      sum += (amplitude / k * std::pow(omega, derivative) * (omega * t_s.array() + advance).sin()).matrix();
    }
    return sum;
  }
};

inline Eigen::VectorXd quantised(const Eigen::VectorXd& values, int bits) {
  const double count = 2 * std::numbers::pi / std::pow(2.0, bits);
  return (values / count).array().round() * count;
}

inline Eigen::VectorXd times(double rate_hz, Eigen::Index samples) {
  return Eigen::VectorXd::LinSpaced(samples, 0.0, static_cast<double>(samples - 1) / rate_hz);
}

inline double rms(const Eigen::VectorXd& x) {
  return std::sqrt(x.squaredNorm() / static_cast<double>(x.size()));
}

}  // namespace deltadyn::testing_support
