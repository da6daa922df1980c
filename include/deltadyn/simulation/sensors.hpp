#pragma once

/// \file
/// What a log shows of a motion: encoders that count, torque with noise, and effects that act on the recorded torque
/// only.

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "deltadyn/runtime/effect_catalogue.hpp"
#include "deltadyn/runtime/random.hpp"

namespace deltadyn {

struct SensorOptions {
  std::vector<double> encoder_step;     ///< of each drive [rad | m]; 0 or empty: exact
  std::vector<double> encoder_noise;    ///< standard deviation before counting [rad | m]
  std::vector<double> torque_noise;     ///< standard deviation [N m | N]
  double torque_noise_correlation = 0;  ///< of samples of the log one after the other, AR(1): 0 is white, below 1

  /// Throws deltadyn::Error(usage) naming the field.
  void validate(int drives) const;
};

/// Reads positions; each reading draws new noise.
class Encoders {
 public:
  Encoders(int drives, const SensorOptions& options, std::uint64_t seed);
  [[nodiscard]] Eigen::VectorXd read(const Eigen::Ref<const Eigen::VectorXd>& q);

 private:
  Eigen::VectorXd step_, noise_;
  std::mt19937_64 random_;
  NormalDistribution normal_;
};

/// True for effects on the recorded torque alone.
[[nodiscard]] bool is_log_effect(EffectId id);

/// The torque that is recorded of the torque that acted, in the order in which a drive spoils it (kStage of the
/// effects), noise last.
/// \param t_s    even times
/// \param tau    samples x drives [N m | N]
/// \param effects  those that are not log effects are passed over
[[nodiscard]] Eigen::MatrixXd recorded_torque(const Eigen::VectorXd& t_s, const Eigen::MatrixXd& tau,
                                              const std::vector<Effect>& effects, const SensorOptions& options,
                                              std::uint64_t seed);

}  // namespace deltadyn
