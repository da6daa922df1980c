#pragma once

/// \file
/// Zero-phase low pass: a Butterworth filter run forwards and backwards.

#include <Eigen/Core>
#include <vector>

namespace deltadyn {

/// One second-order section y_k = b0 x_k + b1 x_{k-1} + b2 x_{k-2} - a1 y_{k-1} - a2 y_{k-2}.
struct SecondOrderSection {
  double b0, b1, b2, a1, a2;
};

/// Digital Butterworth low pass by the bilinear transform with pre-warping; unit gain at zero frequency, -3 dB at
/// `cutoff_hz`. An odd order has one section of first order (b2 = a2 = 0).
/// \param cutoff_hz  between 0 and half the sample rate
/// \param order      1 to 12
/// Throws Error(usage) if an argument is out of range.
[[nodiscard]] std::vector<SecondOrderSection> butterworth_low_pass(double sample_rate_hz, double cutoff_hz, int order);

/// Gain |H|^2 of forward and backward pass together at a frequency.
[[nodiscard]] double zero_phase_gain(const std::vector<SecondOrderSection>& sections, double sample_rate_hz,
                                     double frequency_hz);

/// The cut-off of one pass, for which forward and backward pass together have their -3 dB at `cutoff_hz`.
[[nodiscard]] double single_pass_cutoff_hz(double sample_rate_hz, double cutoff_hz, int order);

/// Filters each column forwards and backwards: no lag, and -3 dB at `cutoff_hz` for both passes together.
///
/// The ends are continued by odd reflection (a straight line stays straight), each pass starts in the steady state of
/// its first value, so constants and straight lines pass unchanged. Still, about 1/cutoff_hz at either end is less
/// certain than the middle.
/// \param columns         N x channels, at least two rows
/// \param sample_rate_hz  of the rows
/// \param cutoff_hz       0 to half the sample rate; at or beyond half the sample rate the data are returned unchanged
/// \param order           of one pass, 1 to 12
/// Throws Error(usage) if an argument is out of range.
[[nodiscard]] Eigen::MatrixXd zero_phase_filter(const Eigen::Ref<const Eigen::MatrixXd>& columns, double sample_rate_hz,
                                                double cutoff_hz, int order = 4);

}  // namespace deltadyn
