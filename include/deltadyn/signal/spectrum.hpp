#pragma once

/// \file
/// Power spectral density after Welch: what a signal is made of.

#include <Eigen/Core>

namespace deltadyn {

struct PowerSpectrum {
  Eigen::VectorXd frequency_hz;  ///< segment/2 + 1 values from 0 to half the sampling rate
  Eigen::VectorXd density;       ///< one-sided [unit^2/Hz]; its integral over frequency is the signal's variance
  Eigen::Index segments = 0;     ///< averaged pieces
  double resolution_hz = 0.0;    ///< distance of the frequencies
};

/// Averages the periodograms of Hann-windowed pieces that overlap by half (Welch 1967); each piece's mean is taken out
/// first.
/// \param signal   N samples at an even rate; NaN marks samples that do not count
/// \param rate_hz  sampling rate
/// \param segment  samples a piece, at most N; 0 chooses the power of two of at most N/4 and 4096 (at least 16)
/// \throws Error if the rate is not positive, the signal is shorter than a piece of 16, or no piece is free of NaN
[[nodiscard]] PowerSpectrum welch_spectrum(const Eigen::VectorXd& signal, double rate_hz, Eigen::Index segment = 0);

}  // namespace deltadyn
