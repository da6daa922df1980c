#pragma once

/// \file
/// Parallel decimation of torque and regressor: a linear-phase low pass with finite support, and every factor-th sample
/// of it.

#include <Eigen/Core>

namespace deltadyn {

/// Windowed-sinc low pass (Kaiser window) with symmetric taps and unit gain at zero frequency: flat to 0.1 % up to half
/// the cut-off, below 0.1 % from 1.5 cut-off on, half way (-6 dB) at the cut-off. The wide transition keeps the support
/// short, so that few rows feel a velocity reversal. No lag. Output k belongs to input sample centre(k) and needs
/// half_width() samples on either side: a log of any length can be processed block by block and in parallel, with the
/// same result.
class FirDecimator {
 public:
  /// \param sample_rate_hz  of the input
  /// \param cutoff_hz       -6 dB point; 0.33 sample_rate_hz/factor keeps aliases out, half of it is the most that is
  ///                        accepted
  /// \param factor          every factor-th filtered sample is kept, at least 1
  /// Throws Error(usage) if an argument is out of range or the cut-off is above half the output rate.
  FirDecimator(double sample_rate_hz, double cutoff_hz, int factor);

  [[nodiscard]] int half_width() const { return static_cast<int>(taps_.size() / 2); }
  [[nodiscard]] int factor() const { return factor_; }
  [[nodiscard]] const Eigen::VectorXd& taps() const { return taps_; }
  /// Input sample at the centre of an output.
  [[nodiscard]] Eigen::Index centre(Eigen::Index output) const { return half_width() + output * factor_; }
  /// Number of outputs of an input with this many samples (0 if it is shorter than the filter).
  [[nodiscard]] Eigen::Index outputs(Eigen::Index samples) const;
  /// Number of input samples that a run of outputs needs, from half_width() before the centre of the first one on.
  [[nodiscard]] Eigen::Index inputs(Eigen::Index n_outputs) const;

  /// Variance of a mean over many outputs of white noise, in units of that of independent outputs with the same
  /// variance.
  [[nodiscard]] double white_correlation() const;

  /// Gain at a frequency [Hz].
  [[nodiscard]] double gain(double frequency_hz) const;

  /// The first outputs of a block of channels, as many as `out` has rows.
  /// \param in   samples x channels, at least inputs(out.rows()) of them
  /// \param out  outputs x channels
  void apply(const Eigen::Ref<const Eigen::MatrixXd>& in, Eigen::Ref<Eigen::MatrixXd> out) const;

 private:
  double sample_rate_hz_;
  int factor_;
  Eigen::VectorXd taps_;
};

}  // namespace deltadyn
