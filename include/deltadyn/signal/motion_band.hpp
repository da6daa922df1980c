#pragma once

/// \file
/// The band of frequencies in which a recorded motion stands out of the noise of its encoders, and the cut-off that
/// follows from it. Neither a model nor a torque is needed, so what a model lacks cannot turn the cut-off.

#include <Eigen/Core>
#include <vector>

#include "deltadyn/signal/log.hpp"

namespace deltadyn {

/// Spectrum of one drive's position in thirds of an octave.
struct MotionBand {
  Eigen::VectorXd frequency_hz;  ///< middle of each band
  Eigen::VectorXd density;       ///< one-sided, mean over the band [rad^2/Hz | m^2/Hz]
  double noise_density = 0;      ///< of encoder step and noise, taken as white [rad^2/Hz | m^2/Hz]
  double top_hz = 0;             ///< the motion stands out of the noise up to here
  double content_hz = 0;         ///< the motion has nearly all of its acceleration below
};

/// \param position  N samples at an even rate
/// \param rate_hz   of the samples
/// Throws deltadyn::Error as welch_spectrum does (fewer than 17 samples, a rate that is not positive).
[[nodiscard]] MotionBand motion_band(const Eigen::Ref<const Eigen::VectorXd>& position, double rate_hz);

/// Standard deviation of the white noise of each drive's positions (encoder step and noise), from their spectra [rad |
/// m]. Throws as motion_band() does.
[[nodiscard]] Eigen::VectorXd position_noise_std(const Log& log);

/// Cut-off of the motion of several logs of one robot.
struct CutoffChoice {
  double cutoff_hz = 0;
  double lowest_hz = 0;  ///< no cut-off below: a log loses too much at its ends
  double band_hz = 0;    ///< the motion of every drive in every log has nearly all of its acceleration below
  /// Up to here encoder noise, as acceleration times inertia, stays below the noise of the torque
  double noise_limit_hz = 0;
  std::vector<std::vector<MotionBand>> bands;  ///< logs x drives
};

/// band_hz, or 20 Hz where that is higher, so that reversals stay short; at most noise_limit_hz, beyond which the
/// filter lets nothing through but noise, which in the regressor pulls the parameters down; within what rate and length
/// of the logs allow. Throws deltadyn::Error (bad_input) if the logs are too short or sampled too slowly for any
/// cut-off.
[[nodiscard]] CutoffChoice choose_cutoff(const std::vector<Log>& logs);

}  // namespace deltadyn
