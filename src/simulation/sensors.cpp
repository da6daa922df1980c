#include "deltadyn/simulation/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/effects/current_lag.hpp"
#include "deltadyn/effects/saturation.hpp"
#include "deltadyn/effects/torque_constant_error.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/random.hpp"

namespace deltadyn {
namespace {

Eigen::VectorXd one_a_drive(const std::vector<double>& values, int drives) {
  if (values.empty()) return Eigen::VectorXd::Zero(drives);
  return Eigen::Map<const Eigen::VectorXd>(values.data(), drives);
}

/// Value of evenly sampled y at k + shift samples, held at the ends.
double shifted(const Eigen::VectorXd& y, Eigen::Index k, double shift) {
  const double at = std::clamp(static_cast<double>(k) + shift, 0.0, static_cast<double>(y.size() - 1));
  const auto low = std::min(static_cast<Eigen::Index>(at), y.size() - 2);
  const double s = at - static_cast<double>(low);
  // Cubic through four neighbours: a line would damp the highest frequencies, which a dead time does not.
  if (low < 1 || low + 2 >= y.size()) return (1 - s) * y(low) + s * y(low + 1);
  const double a = y(low - 1), b = y(low), c = y(low + 1), d = y(low + 2);
  return a * (-s * (s - 1) * (s - 2) / 6) + b * ((s + 1) * (s - 1) * (s - 2) / 2) + c * (-(s + 1) * s * (s - 2) / 2) +
         d * ((s + 1) * s * (s - 1) / 6);
}

}  // namespace

void SensorOptions::validate(int drives) const {
  const auto check = [drives](const std::vector<double>& values, const char* what) {
    if (!values.empty() && static_cast<int>(values.size()) != drives) {
      throw Error(fmt::format("{} {} for {} drives", values.size(), what, drives), "", "give one for each drive",
                  ExitCode::usage);
    }
    for (const double value : values) {
      if (!(value >= 0 && std::isfinite(value)))
        throw Error(fmt::format("{} of {}", what, value), "", "give numbers that are not negative", ExitCode::usage);
    }
  };
  check(encoder_step, "encoder steps");
  check(encoder_noise, "encoder noises");
  check(torque_noise, "torque noises");
  if (!(torque_noise_correlation >= 0 && torque_noise_correlation < 1)) {
    throw Error(fmt::format("a correlation of {} of the torque noise", torque_noise_correlation), "",
                "give a number from 0 (white) to below 1", ExitCode::usage);
  }
}

Encoders::Encoders(int drives, const SensorOptions& options, std::uint64_t seed)
    : step_(one_a_drive(options.encoder_step, drives)), noise_(one_a_drive(options.encoder_noise, drives)), random_(seed) {}

Eigen::VectorXd Encoders::read(const Eigen::Ref<const Eigen::VectorXd>& q) {
  Eigen::VectorXd reading = q;
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    if (noise_(j) > 0) reading(j) += noise_(j) * normal_(random_);
    if (step_(j) > 0) reading(j) = step_(j) * std::round(reading(j) / step_(j));
  }
  return reading;
}

bool is_log_effect(EffectId id) {
  return id == EffectId::saturation || id == EffectId::torque_constant_error || id == EffectId::current_lag ||
         id == EffectId::time_skew;
}

Eigen::MatrixXd recorded_torque(const Eigen::VectorXd& t_s, const Eigen::MatrixXd& tau, const std::vector<Effect>& effects,
                                const SensorOptions& options, std::uint64_t seed) {
  const auto drives = static_cast<int>(tau.cols());
  options.validate(drives);
  Eigen::MatrixXd recorded = tau;
  const Eigen::Index n = tau.rows();
  const double period = n > 1 ? (t_s(n - 1) - t_s(0)) / static_cast<double>(n - 1) : 1.0;
  for (const EffectId stage :
       {EffectId::saturation, EffectId::torque_constant_error, EffectId::current_lag, EffectId::time_skew}) {
    for (const Effect& effect : effects) {
      if (effect.id != stage) continue;
      for (int j = 0; j < drives; ++j) {
        if (effect.joint >= 0 && effect.joint != j) continue;
        const double a = effect.amplitude(0);
        const Eigen::VectorXd before = recorded.col(j);
        CurrentLag<double> lag(std::max(a, 1e-12), n > 0 ? before(0) : 0.0);
        for (Eigen::Index k = 0; k < n; ++k) {
          double& y = recorded(k, j);
          switch (stage) {
            case EffectId::saturation: y += a * saturation(before(k), effect.shape(0)); break;
            case EffectId::torque_constant_error: y += a * torque_constant_error(before(k)); break;
            case EffectId::current_lag:
              if (effect.shape.size() > 1 && effect.shape(1) > 0) {  // the log holds the command, before the lag
                const Eigen::Index low = std::max<Eigen::Index>(k - 1, 0), high = std::min(k + 1, n - 1);
                if (high > low) y += a * current_lead((before(high) - before(low)) / (static_cast<double>(high - low) * period));
                break;
              }
              // The torque's mean over each half of a sample, so that the lag adds no delay of its own.
              if (k > 0 && a > 0) {
                lag.step(before(k - 1), 0.5 * period);
                y = lag.step(before(k), 0.5 * period);
              }
              break;
            default: y = shifted(before, k, -a / period); break;
          }
        }
      }
    }
  }
  const Eigen::VectorXd noise = one_a_drive(options.torque_noise, drives);
  std::mt19937_64 random(seed);
  NormalDistribution normal;
  const double rho = options.torque_noise_correlation, fresh = std::sqrt(1 - rho * rho);
  Eigen::VectorXd state(drives);
  for (int j = 0; j < drives; ++j) state(j) = noise(j) > 0 ? normal(random) : 0.0;
  for (Eigen::Index k = 0; k < n; ++k) {
    for (int j = 0; j < drives; ++j) {
      if (noise(j) <= 0) continue;
      recorded(k, j) += noise(j) * state(j);
      state(j) = rho * state(j) + fresh * normal(random);
    }
  }
  return recorded;
}

}  // namespace deltadyn
