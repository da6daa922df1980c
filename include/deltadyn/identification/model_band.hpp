#pragma once

/// \file
/// The band of frequencies in which the model explains the torque. Above it a machine bends or vibrates, or its
/// controller answers the steps of the encoders: accelerations there belong to another law, and used in a fit they pull
/// the inertia down.

#include <Eigen/Core>
#include <vector>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/identification/log_processing.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/signal/motion_band.hpp"

namespace deltadyn {

/// The torque between two frequencies, beside that of a model whose parameters fit the motion below `low_hz`.
struct ModelBandPart {
  double low_hz = 0, high_hz = 0;
  /// Factor of the model's torque, without Coulomb friction, in the recorded one (least squares; encoder noise and
  /// uncertain parameters taken off): 1 where the model holds, 0 if the record holds nothing of it.
  double found = 0;
  double std = 0;
};

struct ModelBand {
  std::vector<ModelBandPart> parts;  ///< from low frequencies on
  double limit_hz = 0;               ///< the model is good up to here; 0: nothing speaks against the whole band

  /// The part above the limit; null without a limit.
  [[nodiscard]] const ModelBandPart* beyond() const;
};

/// Looks from `lowest_hz` on in parts of half an octave until one is found in which less than half of the model's
/// torque, and certainly not the whole of it, is in the record; if that is the first part, below it, too. Of long logs
/// the middle counts. Where logs tell too little, there is no limit.
/// \param processing  its cut-off and periods are not used
/// Throws deltadyn::Error as prepare_log() does for poses out of reach.
[[nodiscard]] ModelBand find_model_band(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs,
                                        const ProcessingOptions& processing, double lowest_hz, double highest_hz,
                                        int threads = 0);

/// The cut-off for fits and comparisons with this robot: that of the motion (choose_cutoff() of the logs), within the
/// model's band.
struct ModelCutoff {
  CutoffChoice motion;
  ModelBand model;
  double cutoff_hz = 0;
};
/// Throws deltadyn::Error as choose_cutoff() and find_model_band() do.
[[nodiscard]] ModelCutoff choose_model_cutoff(const Robot& robot, const BaseParameters& base,
                                              const std::vector<Log>& logs, const ProcessingOptions& processing,
                                              int threads = 0);

}  // namespace deltadyn
