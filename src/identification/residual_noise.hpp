#pragma once

/// \file
/// Noise of the torque residual as the fit weighs it: memory, robust size, and what encoder noise adds to the
/// accelerations.

#include <Eigen/Core>
#include <vector>

#include "deltadyn/identification/log_processing.hpp"

namespace deltadyn {

/// DriveNoise::correlation of each drive: mean over the logs, weighted by their rows.
/// \param recorded  the logs behind `prepared`, for the steps of their encoders
[[nodiscard]] std::vector<double> correlations(const Robot& robot, const std::vector<Log>& recorded,
                                               const std::vector<PreparedLog>& prepared, const Eigen::VectorXd& p,
                                               const std::vector<bool>& keep_reversals, int threads);

/// Standard deviation of each drive's residual from its median size, which outliers hardly move.
[[nodiscard]] std::vector<double> robust_scales(const Robot& robot, const std::vector<PreparedLog>& prepared,
                                                const Eigen::VectorXd& p, const std::vector<bool>& keep_reversals,
                                                int threads);

/// Largest share, over logs and drives, of the power of the accelerations that is encoder noise.
[[nodiscard]] double acceleration_noise_share(const std::vector<Log>& logs, const std::vector<PreparedLog>& prepared,
                                              const ProcessingOptions& processing);

}  // namespace deltadyn
