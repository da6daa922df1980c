#pragma once

/// \file
/// What encoder noise does to the search: it enters the position and passes the zero-phase filter, the differentiation,
/// the regressor, the low pass and the whitening. Alone it fakes Stribeck and elasticity otherwise.

#include <cstdint>
#include <vector>

#include "deltadyn/diagnosis/diagnose.hpp"

#include "../search/signature.hpp"

namespace deltadyn {

/// Encoder noise through the pipeline, some times: which columns it moves, and what it fakes on average. A column and
/// the residual feel the same noise, so that their product has a mean: a column of second derivatives is the plainest
/// case. All scores are freed of it.
class EncoderPilots {
 public:
  /// \param position_noise  [log][drive], standard deviation of the recorded positions
  EncoderPilots(const EffectModel& model, const BaseParameters& base, const std::vector<LogRows>& logs,
                const VectorXd& p, const WhiteProblem& problem, const std::vector<Hypothesis>& hypotheses,
                const std::vector<Signature>& signatures, const PerLogAndDrive<double>& position_noise,
                double cutoff_hz, double low_pass_hz, const DiagnosisOptions& options);

  /// What one noisy motion changes: base rows of every log, and rows of the sensitive hypotheses.
  struct Run {
    PerLogAndDrive<MatrixXd> Y;
    std::vector<PerLogAndDrive<MatrixXd>> rows;  ///< one a sensitive hypothesis
  };
  [[nodiscard]] Run draw(std::uint64_t seed) const;
  /// What the change of the sensitive hypotheses' columns adds to C^T r, and the residual r for a torque y in white
  /// rows.
  [[nodiscard]] std::vector<VectorXd> products(const WhiteProblem& problem, const Run& run, const VectorXd& y,
                                               VectorXd& r) const;
  /// Mean of C_perp^T r that encoder noise makes, one vector a hypothesis (empty: none).
  [[nodiscard]] std::vector<VectorXd> bias(const WhiteProblem& problem, const std::vector<Signature>& signatures) const;
  /// Fills Signature::clean: the squares that encoder noise adds to the sensitive columns would make amplitudes come
  /// out small.
  void correct(const WhiteProblem& problem, std::vector<Signature>& signatures) const;
  /// Filter taps, one vector a segment, that turn white noise into the torque's own noise: what is left when the
  /// encoder's part is taken from the unit spectrum of the white residual. \param share  the encoder's share of the
  /// variance
  [[nodiscard]] std::vector<VectorXd> torque_noise(const WhiteProblem& problem, double& share) const;

  [[nodiscard]] const std::vector<std::size_t>& sensitive() const { return sensitive_; }
  /// The model's torque in white rows.
  [[nodiscard]] VectorXd clean(const WhiteProblem& problem) const;

 private:
  [[nodiscard]] Run rows_of(const std::vector<PreparedLog>& motion, const std::vector<std::size_t>& which) const;
  [[nodiscard]] std::vector<PreparedLog> motion(std::uint64_t seed) const;

  const EffectModel& model_;
  const BaseParameters& base_;
  /// Motion only, every few samples: the low pass that follows needs no more
  struct Thinned : LogRows {
    Index step = 1, start = 0, samples = 0;  ///< of the log as recorded: sample = start + k step, of so many
    double rate_hz = 0;                      ///< of that log
  };
  [[nodiscard]] static Thinned thinned(const LogRows& from, double low_pass_hz);

  std::vector<Thinned> logs_;
  Run still_;  ///< without noise
  const VectorXd p_;
  const std::vector<Hypothesis> hypotheses_;
  PerLogAndDrive<double> position_noise_;
  double cutoff_hz_, noisy_column_;
  std::vector<std::size_t> sensitive_;
  std::vector<Run> runs_;
};

/// C_perp^T r freed of what encoder noise fakes. The noise of the positions is known to some tenths of its variance
/// only (quantisation is not white), so that a share of the fake counts as nothing.
[[nodiscard]] VectorXd freed_of_bias(const VectorXd& inner, const VectorXd& bias);

}  // namespace deltadyn
