#pragma once

/// \file
/// A small part of the logs, ready for the hypotheses of the gate: whatever their length, some ten seconds of motion
/// are enough to see a wrong sign, a delay or a unit.

#include <Eigen/Core>
#include <vector>

#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/signal/log.hpp"

namespace deltadyn::gate {

/// Consecutive samples of one log on a grid of their own, some 13 points a period of the band.
struct Stretch {
  int file = 0;                ///< of file_numbers()
  double step_s = 0;           ///< of the grid
  Eigen::MatrixXd q, qd, qdd;  ///< N x drives, low-passed at twice Sample::band_hz
  Eigen::MatrixXd tau;         ///< N x drives; a mean over the grid's step where the log is sampled finer
  std::vector<char> spoilt;    ///< 1: filled in or spoilt, no evidence
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> torque_out;  ///< N x drives: Log::torque_out
  /// [first, last): not disturbed by the ends of the filter
  Eigen::Index first = 0, last = 0;

  [[nodiscard]] Eigen::Index points() const { return q.rows(); }
};

struct Sample {
  std::vector<Stretch> stretches;
  double band_hz = 0;  ///< -6 dB point of the Gaussian low pass that regressor and torque share
  double sigma_s = 0;  ///< of that Gaussian
  /// Even in the lowest band the encoders' noise is not small beside the motion: a large residual means nothing
  bool coarse = false;
};

struct SampleOptions {
  int stretches = 12;  ///< a log that is longer than its share
  double highest_band_hz = 40;
  double lowest_band_hz = 8;

  /// A sample in one band, whatever the noise.
  [[nodiscard]] static SampleOptions in_band(double hz) { return {.highest_band_hz = hz, .lowest_band_hz = hz}; }
};

/// Band by the noise of the motion: the highest one at which encoder noise stays small beside the acceleration of the
/// log with the strongest motion. No torque takes part, so that a fault of the torque cannot move it.
/// \param coarse  set if the noise is too large even in the lowest band
[[nodiscard]] double noise_limited_band_hz(const std::vector<Log>& pieces, const SampleOptions& options,
                                           bool* coarse = nullptr);

/// The number of each log's file, from 0 in the order of the list: parts of one file share its delays.
[[nodiscard]] std::vector<int> file_numbers(const std::vector<Log>& logs);

/// Recorded torque of one drive, a column a stretch.
[[nodiscard]] std::vector<Eigen::VectorXd> recorded_torque(const Sample& sample, Eigen::Index drive);

/// Logs too short for a stretch are left out; the result may be empty.
[[nodiscard]] Sample take_sample(const std::vector<Log>& logs, const SampleOptions& options = {});

/// How much of a residual the noise of the torque record makes by itself: white noise of the recorded torques (the
/// floor of their spectra) under the sample's Gaussian, over the torques under it; rms over the drives, as
/// Timing::rms_after counts.
[[nodiscard]] double relative_torque_noise(const std::vector<Log>& logs, const Sample& sample);

}  // namespace deltadyn::gate
