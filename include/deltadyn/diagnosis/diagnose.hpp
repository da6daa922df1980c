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

#include "deltadyn/diagnosis/policy.hpp"
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

/// The rule that decided the verdict. All but the first stand in one table, in the order in which they are tried
/// (src/diagnosis/verdict/rules.cpp).
enum class VerdictReason {
  logs_too_short,             ///< not_testable: too few rows beside velocity reversals
  names_explain_too_little,   ///< unknown_structure: of what is there, the best of the catalogue explains a part
  structure_without_name,     ///< unknown_structure: the residual follows the motion, and no effect explains it
  holdout_contradicts_names,  ///< unknown_structure: plain in training, and the names do not help the hold-out log
  slow_torque,                ///< unknown_structure: a drive bears a slow torque far above the noise of its record
  course_open,                ///< not_testable: friction that bends, from logs too slow to show where it goes
  holdout_moves_elsewhere,    ///< not_testable: the hold-out log is missed where the training logs did not move
  base_parameters_hidden,     ///< not_testable: the motion does not show all base parameters
  nothing_counts,             ///< nothing_missing
  holdout_too_short,          ///< not_testable: the hold-out log has too few rows to bear the names out
  written_model_refused,      ///< unknown_structure: plain in training, but what would be written fails or is no better
  not_borne_out,              ///< nothing_missing: the same of a trace
  several_names_fit,          ///< confusable
  one_name_fits               ///< named
};

/// "one-name-fits", ...
[[nodiscard]] const char* reason_name(VerdictReason reason);

/// What the proof of the model that would be written said.
enum class WrittenModelIs { not_tried, better, no_better, not_testable };

/// All that the rules look at.
struct VerdictFacts {
  std::size_t names = 0;          ///< effects that count, that a machine can have and the hold-out log asks for, too
  std::size_t open_courses = 0;   ///< of these, friction whose course beyond the logs' speeds is open
  bool sets = false;              ///< one of them has others that cannot be told from it
  double explained_share = 0;     ///< of all structure, by the names
  double structure_left = 0;      ///< beside the names, clear of noise, over the noise variance of the worst drive
  bool structure_counts = false;  ///< that is as large as the noise, or material and found again on the hold-out log
  double holdout_gap = 1;         ///< rms over floor on the hold-out log, of the worst drive that the names reach
  double holdout_left = 1;        ///< rms with the names over what training makes one expect, of the worst of these
  double gap_closed = 1;          ///< share of that gap that the names close; 1 without names or hold-out log
  double gap_closed_at_most = 1;  ///< upper end of its 95 % interval
  bool overt = false;             ///< without the names a drive stands plainly above its floor
  int slow_drive = -1;            ///< that bears a slow torque which nothing explains; -1: none
  int missed_drive = -1;          ///< whose hold-out log is missed where training shows nothing; -1: none
  bool base_hidden = false;       ///< the motion does not show all base parameters
  WrittenModelIs written = WrittenModelIs::not_tried;
};

struct DiagnosisOptions {
  /// cutoff_hz counts only if choose_cutoff is false; bristles and ripples are the model's
  ProcessingOptions processing;
  bool choose_cutoff = true;
  double false_naming_rate = 0.01;  ///< chance that an effect is named on logs that miss nothing
  int max_effects = 3;
  int null_runs = 200;
  std::uint64_t seed = 1;
  int threads = 0;
  bool identify = true;  ///< fit the consistent parameters of the model with the effects
  /// What that fit keeps to where the logs do not decide, in the robot's layout; empty: the model's parameters. The
  /// prior of the model is better than these: where forces were missing, masses had to make up for them.
  Eigen::VectorXd prior;
  DiagnosisPolicy policy;                ///< thresholds; a study varies them, users leave them
  std::function<void(double)> progress;  ///< called with the share done; may be empty

  /// Throws deltadyn::Error(usage) naming the field.
  void validate() const;
};

/// What speaks against an effect.
enum class Objection { none, explains_too_little, holdout_denies, no_better_with_more_parameters };

/// One effect that could be.
struct EffectCandidate {
  Effect effect;  ///< shape and amplitude that fit best
  std::string name, effect_class, joint;
  double gain = 0;     ///< fall of the sum of squares in white rows
  double p_value = 1;  ///< chance of that gain on clean logs, all candidates considered
  Objection objection = Objection::none;
  /// Of one in the set of a named effect: its gain over that one's, and the |cosine| between their torques
  double gain_share = 0, alike = 0;

  /// "NAME at drive1"
  [[nodiscard]] std::string at_joint() const { return name + " at " + joint; }
};

struct NamedEffect : EffectCandidate {
  double explained_share = 0;               ///< of the structure that is there, 0 to 1
  std::vector<EffectCandidate> confusable;  ///< what else it could be
  std::vector<int> drives;                  ///< that it reaches, from 0
  double low_rate = 0, high_rate = 0;       ///< of the first of them: hold 80 % of its torque's square [rad/s | m/s]
  /// On the hold-out log (else the training logs), over those drives
  double rms_before = 0, rms_after = 0, rms_floor = 0;
};

/// What became of an effect in the search.
enum class Ruling {
  no_evidence,
  found,
  about_a_sample,  ///< a skew or lag that is corrected without a name
  like_another,    ///< cannot be told from the named one
  absorbed,        ///< by a re-fit of the parameters: these motions cannot show it
  left_by_form,    ///< a trace too small to matter, or what the named effect's form leaves
  beside_nothing,  ///< alone it explains something, beside the named one nothing
  trace,           ///< too small to matter
  wrong_sign,
  not_confirmed,  ///< it fits, but is not named
  holdout_denies  ///< it fits, but the hold-out log does not bear it out
};

/// One row of the list of all effects considered.
struct ConsideredEffect {
  std::string name, effect_class, joint, unit;
  Ruling ruling = Ruling::no_evidence;
  std::string other;       ///< of like_another and beside_nothing: the named effect
  double other_share = 0;  ///< of beside_nothing: its gain alone over that of the named one
  /// Share of its signature that a re-fit of the parameters cannot absorb (known before any torque)
  double kept = 0;
  double detectable = 0;               ///< smallest amplitude that these logs show with this noise
  double gain_alone = 0, p_alone = 1;  ///< beside the base model
  double gain_left = 0, p_left = 1;    ///< beside the named effects
  std::vector<std::string> like;       ///< effects whose signature these motions hardly tell apart, with their |cosine|

  /// Is it this effect at this place?
  [[nodiscard]] bool is(const EffectCandidate& candidate) const {
    return name == candidate.name && joint == candidate.joint;
  }
};

/// What is to be said beside the verdict; the numbers are those that its words need (report/diagnosis_text.cpp).
struct Remark {
  enum class Kind {
    periods_not_averaged,
    bristle_left_out,     ///< drive
    rest_is_not_coulomb,  ///< of `who`, below value times its rate
    about_a_sample,       ///< torque and positions of `who` are value [s] apart
    not_on_holdout,       ///< `who` fits the training logs only
    may_be_nothing,       ///< `who`: its interval holds zero
    resonance_in_band,    ///< `who`: value [Hz] in a band up to other [Hz]
    trace_makes_worse,    ///< `who` closes value of the gap on the hold-out log
    no_holdout,
    not_identified,   ///< `who` is the cause
    explains_a_part,  ///< `who` explains value of the structure
    contradicted,     ///< `who` closes value of the gap on the hold-out log
    machine_changed,  ///< drive: value on the hold-out log, other in training [N m | N]
    // `who` at the drive bends over the rate; value: rate to record [rad/s | m/s]
    course_is_a_power,
    course_ends_within,    ///< other: largest rate of the logs over that of the bend
    course_unsure,         ///< other: standard deviation over size
    course_missed_beyond,  ///< other: share of the gap that it closes on the faster hold-out log
    refused,               ///< `who`: value [N m | N] with it, other as given, at the drive
    too_few_rows           ///< of the hold-out log, to bear `who` out
  };
  Kind kind;
  std::string who = {};
  int drive = -1;
  double value = 0, other = 0;
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
  VerdictReason reason = VerdictReason::nothing_counts;
  VerdictFacts facts;              ///< that the rule looked at
  std::vector<NamedEffect> named;  ///< the one that explains most first
  std::vector<Effect> denied;      ///< by the hold-out log, the one that fits best first
  std::vector<Remark> remarks;
  std::vector<ConsideredEffect> considered;
  std::vector<DriveFit> drives;
  int place = -1;                                    ///< drive from 0 at which the verdict was decided; -1: none
  double p_value = 1;                                ///< of the verdict
  double explained_share = 0;                        ///< of all structure, by the named effects
  double gap_shrink = 0, gap_low = 0, gap_high = 0;  ///< on the hold-out log, with its 95 % interval; NaN without one
  double length_s = 0;                               ///< of the training logs
  std::optional<double> needed_s;                    ///< not_testable for shortness: length that would do
  Eigen::Index holdout_rows = 0;                     ///< holdout_too_short: rows of the place away from reversals
  std::vector<Effect> effects;                       ///< of the improved model: those it had and the named ones
  std::optional<Identification> improved;            ///< parameters with the effects
  /// One a drive, of the improved model; empty without one or without hold-out log
  std::vector<HoldoutFigure> holdout_figures;
  double holdout_cutoff_hz = 0;  ///< of these figures; 0: the one that delta-validate chooses
  std::vector<DiagnosisTrace> traces;
  double cutoff_hz = 0, encoder_share = 0, total_time_s = 0;
  int null_runs = 0;
};

/// \param p        parameters of the model, in the robot's layout
/// \param p_std    standard deviations of what the re-identification keeps to, or empty
/// \param known    effects that the model holds already
/// \param holdout  a log that takes no part in the search; null: none
/// Throws deltadyn::Error for logs that do not belong to the robot, a hold-out log that is a training log, and options
/// out of range.
[[nodiscard]] Diagnosis diagnose(const Robot& robot, const std::vector<Log>& logs, const Log* holdout,
                                 const Eigen::VectorXd& p, const Eigen::VectorXd& p_std,
                                 const std::vector<Effect>& known, const DiagnosisOptions& options);

}  // namespace deltadyn
