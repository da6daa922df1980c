#pragma once

/// \file
/// What the scores are when nothing is missing: the whole pipeline on simulated clean logs.
///
/// Encoder noise enters the position and passes the zero-phase filter, the differentiation, the regressor, the low pass
/// and the whitening; torque noise enters as the fitted autoregression. Encoder noise alone fakes Stribeck and
/// elasticity otherwise.

#include <cstdint>
#include <functional>
#include <vector>

#include "deltadyn/diagnosis/diagnose.hpp"

#include "generic_basis.hpp"
#include "white_problem.hpp"

namespace deltadyn {

/// Distribution of one score: empirical below its upper quarter, exponential above (the tail of a chi-square or of a
/// supremum of some).
class NullDistribution {
 public:
  NullDistribution() = default;
  explicit NullDistribution(std::vector<double> values);
  /// Chance of a score this large or larger.
  [[nodiscard]] double p_value(double score) const;
  /// Score with this chance.
  [[nodiscard]] double quantile(double p) const;

 private:
  std::vector<double> sorted_;
  double knee_ = 0, slope_ = 1;
};

/// The generic basis of each drive in white rows, and how much a residual holds of it.
class Omnibus {
 public:
  Omnibus() = default;
  Omnibus(const WhiteProblem& problem, const GenericBasis& basis);
  [[nodiscard]] Index drives() const { return static_cast<Index>(white_.size()); }
  /// Fall of the sum of squares of a residual r, one value a drive.
  [[nodiscard]] VectorXd gains(const WhiteProblem& problem, const VectorXd& r, const VectorXd& Q_r) const;
  /// The same of the problem's own residual.
  [[nodiscard]] VectorXd gains(const WhiteProblem& problem) const { return gains(problem, problem.r, problem.Q_r); }
  /// Coefficients of the basis for the part of the structure of one drive that stands out of the noise.
  [[nodiscard]] VectorXd clear_part(const WhiteProblem& problem, std::size_t drive) const;
  /// Gain of each coordinate of the basis alone, for one drive: where the structure lies.
  [[nodiscard]] std::vector<std::pair<std::string, double>> by_coordinate(const WhiteProblem& problem,
                                                                          std::size_t drive) const;

 private:
  std::vector<WhiteColumns> white_;  ///< one a drive
  std::vector<MatrixXd> root_;       ///< gain = |root^T u|^2
  std::vector<std::vector<std::string>> coordinate_;
};

/// Encoder noise through the pipeline, some times: which columns it moves, and what it fakes on average. A column and
/// the residual feel the same noise, so that their product has a mean: a column of second derivatives is the plainest
/// case. All scores are freed of it.
class EncoderPilots {
 public:
  /// \param position_noise  [log][drive], standard deviation of the recorded positions
  EncoderPilots(const EffectModel& model, const BaseParameters& base, const std::vector<LogRows>& logs,
                const VectorXd& p, const WhiteProblem& problem, const std::vector<Hypothesis>& hypotheses,
                const std::vector<Signature>& signatures, const PerLogAndDrive<double>& position_noise,
                double cutoff_hz, double low_pass_hz, std::uint64_t seed, int threads);

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
  double cutoff_hz_;
  std::vector<std::size_t> sensitive_;
  std::vector<Run> runs_;
};

/// C_perp^T r freed of what encoder noise fakes. The noise of the positions is known to some tenths of its variance
/// only (quantisation is not white), so that a share of the fake counts as nothing.
[[nodiscard]] VectorXd freed_of_bias(const VectorXd& inner, const VectorXd& bias);

struct NullStudy {
  std::vector<NullDistribution> hypothesis;  ///< one a hypothesis
  NullDistribution family;                   ///< of -log of the smallest p of all hypotheses (Westfall and Young 1993)
  std::vector<NullDistribution> omnibus;     ///< one a drive
  NullDistribution omnibus_family;
  double encoder_share = 0;  ///< of the white residual's variance that encoder noise makes

  /// p of one score corrected for having looked at all hypotheses.
  [[nodiscard]] double family_p(std::size_t index, double score) const;
  [[nodiscard]] double omnibus_p(const VectorXd& gains) const;
};

/// \param bias      EncoderPilots::bias of the same problem
/// \param progress  called with the share done
[[nodiscard]] NullStudy run_null_study(const EncoderPilots& pilots, const WhiteProblem& problem,
                                       const std::vector<Hypothesis>& hypotheses,
                                       const std::vector<Signature>& signatures, const std::vector<VectorXd>& bias,
                                       const Omnibus& omnibus, const DiagnosisOptions& options,
                                       const std::function<void(double)>& progress);

}  // namespace deltadyn
