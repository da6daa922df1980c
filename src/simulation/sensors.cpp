#include "deltadyn/simulation/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/random.hpp"

namespace deltadyn {
namespace {

Eigen::VectorXd one_a_drive(const std::vector<double>& values, int drives) {
  if (values.empty()) return Eigen::VectorXd::Zero(drives);
  return Eigen::Map<const Eigen::VectorXd>(values.data(), drives);
}

/// Place of an effect on the recorded torque in the order in which a drive spoils its signal; -1 for all others.
int stage_of(EffectId id) {
  int stage = -1;
  visit_effect(id, [&stage](auto effect) {
    using E = decltype(effect);
    if constexpr (kIs<E, RecordedChange>) stage = E::kStage;
  });
  return stage;
}

void record(const Effect& effect, double period, Eigen::MatrixXd& torque) {
  for (int j = 0; j < torque.cols(); ++j) {
    if (effect.joint >= 0 && effect.joint != j) continue;
    visit_effect(effect.id, [&](auto type) {
      using E = decltype(type);
      const Eigen::VectorXd before = torque.col(j);
      if constexpr (kIs<E, RecordedChange>)
        torque.col(j) = E::record(before, period, effect.amplitude(0), shape_of(effect));
    });
  }
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
    : step_(one_a_drive(options.encoder_step, drives)),
      noise_(one_a_drive(options.encoder_noise, drives)),
      random_(seed) {}

Eigen::VectorXd Encoders::read(const Eigen::Ref<const Eigen::VectorXd>& q) {
  Eigen::VectorXd reading = q;
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    if (noise_(j) > 0) reading(j) += noise_(j) * normal_(random_);
    if (step_(j) > 0) reading(j) = step_(j) * std::round(reading(j) / step_(j));
  }
  return reading;
}

bool is_log_effect(EffectId id) {
  return stage_of(id) >= 0;
}

Eigen::MatrixXd recorded_torque(const Eigen::VectorXd& t_s, const Eigen::MatrixXd& tau,
                                const std::vector<Effect>& effects, const SensorOptions& options, std::uint64_t seed) {
  const auto drives = static_cast<int>(tau.cols());
  options.validate(drives);
  Eigen::MatrixXd recorded = tau;
  const Eigen::Index n = tau.rows();
  const double period = n > 1 ? (t_s(n - 1) - t_s(0)) / static_cast<double>(n - 1) : 1.0;
  std::vector<Effect> in_order = effects;
  std::erase_if(in_order, [](const Effect& effect) { return !is_log_effect(effect.id); });
  std::ranges::stable_sort(in_order, {}, [](const Effect& effect) { return stage_of(effect.id); });
  for (const Effect& effect : in_order) record(effect, period, recorded);
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
