#pragma once

/// \file
/// Cut-off of the motion, from the logs themselves: too low a cut-off bends the accelerations, too high a one lets encoder noise
/// through, so that the residual has a minimum between. No parameters are needed, so that every model is judged at the same cut-off.

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "deltadyn/identification/log_processing.hpp"

namespace deltadyn {

/// What a drive's own regressor leaves of its torque, as recorded, when the motion is filtered at this cut-off.
struct CutoffPoint {
  double cutoff_hz;
  double score;         ///< geometric mean over the drives of rms [N m | N]
  Eigen::VectorXd rms;  ///< of each drive; rows near velocity reversals left out
};

/// Tries cut-offs a third of an octave apart, from low ones on until the residual has clearly risen again.
/// \param processing  its cut-off is not used
/// \param progress    called with the share done, 0 to 1; may be empty
/// Throws deltadyn::Error if the sampling rate is too low or the logs are too short.
[[nodiscard]] std::vector<CutoffPoint> scan_cutoffs(const Robot& robot, const std::vector<Log>& logs,
                                                    const ProcessingOptions& processing, int threads = 0,
                                                    const std::function<void(double)>& progress = {});

/// The cut-off with the smallest score [Hz].
[[nodiscard]] double best_cutoff_hz(const std::vector<CutoffPoint>& points);

}  // namespace deltadyn
