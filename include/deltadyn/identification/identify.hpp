#pragma once

/// \file
/// The main job: logs in, physically consistent parameters with their uncertainty out.

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/identification/consistent_fit.hpp"
#include "deltadyn/identification/log_processing.hpp"
#include "deltadyn/identification/model_band.hpp"
#include "deltadyn/identification/presliding_search.hpp"
#include "deltadyn/signal/motion_band.hpp"

namespace deltadyn {

/// What happens to rows near velocity reversals, where the Coulomb model of friction does not hold.
enum class Reversals {
  automatic,  ///< leave them out if the model fits them three times worse than the other rows, drive by drive
  mask,       ///< always leave them out
  keep        ///< never
};

struct IdentificationOptions {
  ProcessingOptions processing;  ///< cutoff_hz counts only if choose_cutoff is false
  /// From the band in which the motion stands out of the encoders' noise and the model holds
  bool choose_cutoff = true;
  Reversals reversals = Reversals::automatic;
  bool robust = false;  ///< Huber weights: single rows that stand out count less
  /// Waves of the torque over the position become part of the model; only where reversals are automatic.
  bool find_ripples = true;
  BaseParameterOptions base;
  ConsistentFitOptions fit;
  int threads = 0;                       ///< 0: all
  std::function<void(double)> progress;  ///< called with the share done, 0 to 1; may be empty
};

struct DriveReport {
  Eigen::Index rows = 0;         ///< used
  Eigen::Index masked_rows = 0;  ///< left out near reversals
  double reversal_ratio = 1;     ///< rms near reversals over rms elsewhere, of the fit without them
  double rms_base = 0;           ///< residual of the base parameters [N m | N]
  double rms = 0;                ///< residual of the consistent parameters
  double rms_torque = 0;
  DriveNoise noise;
};

struct Identification {
  BaseParameters base;
  BaseEstimate base_estimate;
  Eigen::VectorXd base_from_fit;  ///< B p of the consistent parameters, to compare with base_estimate
  ConsistentFitSummary fit;
  std::vector<DriveReport> drives;
  std::optional<CutoffChoice> cutoff;       ///< empty if the cut-off was given
  std::optional<ModelBand> model_band;      ///< the same
  std::vector<PreslidingJoint> presliding;  ///< of each joint with friction; empty if it was not looked for
  ProcessingOptions processing;             ///< as used
  std::vector<bool> keep_reversals;         ///< one a drive: its rows near reversals were used
  double noise_share = 0;  ///< largest, of the power of an acceleration, that is encoder noise; taken out if it is felt
  Eigen::Index samples = 0;
  double fold_time_s = 0, total_time_s = 0;
  std::vector<std::string> notes;
};

/// Identifies the parameters of `robot` from one or more logs.
/// \param prior      one value a parameter of the robot, physically consistent
/// \param prior_std  the same, or empty: then 30 % of the prior
/// Throws deltadyn::Error as the steps do.
[[nodiscard]] Identification identify(const Robot& robot, const std::vector<Log>& logs, const Eigen::VectorXd& prior,
                                      const Eigen::VectorXd& prior_std, const IdentificationOptions& options);

}  // namespace deltadyn
