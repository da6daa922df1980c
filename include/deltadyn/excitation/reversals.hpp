#pragma once

/// \file
/// How much of a motion is away from velocity reversals. An identification leaves out the rows near them, where the
/// sign of Coulomb friction is uncertain: what a low pass reaches on either side of a reversal of the drive, and of the
/// telescope in the drives of the limbs.

#include <Eigen/Core>

#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/trajectory/samples.hpp"

namespace deltadyn {

/// Time on either side of a reversal that counts as near it [s].
/// \param low_pass_hz  of regressor and torque
/// Throws deltadyn::Error(usage) if the rate is too low for it.
[[nodiscard]] double reversal_reach_s(double low_pass_hz, double rate_hz);

/// Share of the samples away from reversals, one a drive [0, 1].
/// \param floor  a rate below this share of the joint's largest one has no certain sign
[[nodiscard]] Eigen::VectorXd share_away_from_reversals(const Robot& robot, const TrajectorySamples& samples,
                                                        double reach_s, double floor);

/// The same judgement on one instant, smooth: one where the joint is far from a reversal, zero at it, one half where it
/// would reverse after `reach_s` at this acceleration.
struct SmoothDistance {
  double value = 1, by_rate = 0, by_acceleration = 0;
};
/// \param least_rate  of the joint: keeps the value defined at rest
[[nodiscard]] SmoothDistance distance_from_reversal(double rate, double acceleration, double reach_s,
                                                    double least_rate);

}  // namespace deltadyn
