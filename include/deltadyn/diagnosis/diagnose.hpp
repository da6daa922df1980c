#pragma once

/// \file
/// The missing-effect workflow: where a model and its logs disagree, the name of what is missing, the model with it,
/// and the proof on a log that took no part. Honest by construction: nothing-missing, a set, unknown-structure or
/// not-testable where that is the truth.

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "deltadyn/identification/effect_torque.hpp"
#include "deltadyn/runtime/effect_catalogue.hpp"

namespace deltadyn {

enum class DiagnosisVerdict { nothing_missing, named, confusable, unknown_structure, not_testable };
/// "nothing-missing", "named", ...
[[nodiscard]] const char* verdict_name(DiagnosisVerdict verdict);
/// Does the verdict give a name, alone or with others of its set?
[[nodiscard]] constexpr bool gives_a_name(DiagnosisVerdict verdict) {
  return verdict == DiagnosisVerdict::named || verdict == DiagnosisVerdict::confusable;
}

struct DiagnosisOptions {
  /// cutoff_hz counts only if choose_cutoff is false; bristles and ripples are the model's
  ProcessingOptions processing;
  bool choose_cutoff = true;
  double false_naming_rate = 0.01;  ///< chance that an effect is named on logs that miss nothing
  int max_effects = 3;
  int null_runs = 200;
  std::uint64_t seed = 1;
  int threads = 0;
  bool identify = true;                  ///< fit the consistent parameters of the model with the effects
  std::function<void(double)> progress;  ///< called with the share done; may be empty

  /// Throws deltadyn::Error(usage) naming the field.
  void validate() const;
};

/// One effect that could be.
struct EffectCandidate {
  Effect effect;  ///< shape and amplitude that fit best
  std::string name, effect_class, joint;
  double gain = 0;     ///< fall of the sum of squares in white rows
  double p_value = 1;  ///< chance of that gain on clean logs, all candidates considered
  std::string why;     ///< why it is (not) told apart from the best one

  /// "NAME at drive1"
  [[nodiscard]] std::string at_joint() const { return name + " at " + joint; }
};

struct NamedEffect : EffectCandidate {
  double explained_share = 0;               ///< of the structure that is there, 0 to 1
  std::vector<EffectCandidate> confusable;  ///< what else it could be
  std::string region;                       ///< where it acts, in words
  std::vector<int> drives;                  ///< that it reaches, from 0
  /// On the hold-out log (else the training logs), over those drives
  double rms_before = 0, rms_after = 0, rms_floor = 0;
};

/// One row of the list of all effects considered.
struct ConsideredEffect {
  std::string name, effect_class, joint, unit, ruling;
  /// Share of its signature that a re-fit of the parameters cannot absorb (known before any torque)
  double kept = 0;
  double detectable = 0;               ///< smallest amplitude that these logs show with this noise
  double gain_alone = 0, p_alone = 1;  ///< beside the base model
  double gain_left = 0, p_left = 1;    ///< beside the named effects
  std::vector<std::string> like;       ///< effects whose signature these motions hardly tell apart, with their |cosine|
};

/// A drive on the hold-out log, as delta-validate shows it for the model as given and for the one that is written.
struct HoldoutFigure {
  double rms_given = 0, rms_written = 0;  ///< rows near velocity reversals left out [N m | N]
  Eigen::Index rows_given = 0, rows_written = 0;
};

/// Rows of one drive in one log that the search uses.
struct RowCount {
  Eigen::Index whole = 0, part = 0, all = 0;  ///< used whole; in the directions that no reversal hides; of the log
};

/// How one drive fits.
struct DriveFit {
  /// On the training logs: base model fitted to them, with the named effects, no model can do better.
  double rms = 0, rms_after = 0, floor = 0;
  double rms_given = 0;                       ///< of the model as the user gave it, not fitted to these logs
  double rms_holdout = 0, floor_holdout = 0;  ///< of the fitted base model on the hold-out log; 0 without one
  /// Share of the base model's residual variance that follows the motion
  double structure = 0;
  double p_value = 1, p_left = 1;  ///< of the structure: before, and beside the named effects
  std::vector<RowCount> rows;      ///< one a training log, then the hold-out log
  /// Coordinates that it follows, with their share, largest first
  std::vector<std::pair<std::string, double>> follows;
};

/// Rows of one log for pictures; matrices rows x drives.
struct DiagnosisTrace {
  std::string file;
  bool holdout = false;
  Eigen::VectorXd t_s;
  Eigen::MatrixXd q, qd, torque, before, after;  ///< measured torque and residuals
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> usable;
};

struct Diagnosis {
  DiagnosisVerdict verdict = DiagnosisVerdict::nothing_missing;
  std::string headline;            ///< one sentence
  std::vector<std::string> lines;  ///< what was found, in plain words
  std::vector<std::string> next;   ///< what to do next
  std::vector<NamedEffect> named;  ///< the first one decides the verdict
  std::vector<ConsideredEffect> considered;
  std::vector<DriveFit> drives;
  std::string region;                                ///< of unknown structure
  double p_value = 1;                                ///< of the verdict
  double explained_share = 0;                        ///< of all structure, by the named effects
  double gap_shrink = 0, gap_low = 0, gap_high = 0;  ///< on the hold-out log, with its 95 % interval; NaN without one
  std::optional<double> needed_s;                    ///< not_testable for shortness: length that would do
  std::vector<Effect> effects;                       ///< of the improved model: those it had before and the named ones
  std::optional<Identification> improved;            ///< parameters with the effects
  /// One a drive, of the improved model; empty without one or without hold-out log
  std::vector<HoldoutFigure> holdout_figures;
  double holdout_cutoff_hz = 0;  ///< of these figures; 0: the one that delta-validate chooses
  std::vector<DiagnosisTrace> traces;
  double cutoff_hz = 0, encoder_share = 0, total_time_s = 0;
  int null_runs = 0;
  std::vector<std::string> notes;
};

/// \param p        parameters of the model, in the robot's layout
/// \param p_std    their standard deviations or empty, for the re-identification
/// \param known    effects that the model holds already
/// \param holdout  a log that takes no part in the search; null: none
/// Throws deltadyn::Error for logs that do not belong to the robot, a hold-out log that is a training log, and options
/// out of range.
[[nodiscard]] Diagnosis diagnose(const Robot& robot, const std::vector<Log>& logs, const Log* holdout,
                                 const Eigen::VectorXd& p, const Eigen::VectorXd& p_std,
                                 const std::vector<Effect>& known, const DiagnosisOptions& options);

}  // namespace deltadyn
