#pragma once

/// \file
/// The motion that tells a set of effects apart: T-optimal over the coefficients of a Fourier series (Atkinson and
/// Fedorov 1975): as much as possible of the alternative's torque must be left when the best effect and all parameters
/// are re-fitted.

#include <cstdint>
#include <optional>
#include <string>

#include "deltadyn/diagnosis/diagnose.hpp"
#include "deltadyn/trajectory/samples.hpp"

namespace deltadyn {

struct NextExperiment {
  TrajectorySamples samples;  ///< with run-in and run-out
  std::string note;           ///< one line, what it separates and how well
};

/// Within the positions, rates and accelerations of the training logs (and the robot's own limits).
/// \returns nothing if no effect was named with an alternative
[[nodiscard]] std::optional<NextExperiment> plan_next_experiment(const Robot& robot, const Diagnosis& diagnosis,
                                                                 const Eigen::VectorXd& p, std::uint64_t seed);

}  // namespace deltadyn
