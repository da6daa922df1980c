#pragma once

/// \file
/// The steps of diagnose(), between them the search's result.

#include <memory>
#include <utility>
#include <vector>

#include "deltadyn/diagnosis/diagnose.hpp"

#include "effect_search.hpp"
#include "written_proof.hpp"

namespace deltadyn::detail {

/// What diagnose() is given.
struct DiagnosisInput {
  const Robot& robot;
  const std::vector<Log>& logs;
  const Log* holdout;
  const VectorXd &p, &p_std;         ///< of the model as given
  const std::vector<Effect>& known;  ///< effects of the model as given
  const DiagnosisOptions& options;
  const ValidatedLogs &training, &held;  ///< `held` has none without a hold-out log
};

struct SearchContext {
  const Robot& robot;
  const EffectModel& model;
  const BaseParameters& base;
  const std::vector<LogRows>& logs;
  const GenericBasis& basis;
  const EffectSearch& search;
  const DiagnosisOptions& options;
  const ProcessingOptions& processing;
  const VectorXd& p;
  PerLogAndDrive<double> position_noise = {};
  const LogRows* holdout = nullptr;  ///< evaluated in `basis` behind the logs
};

struct SearchResult {
  PerLogAndDrive<NoiseModel> noise;   ///< beside everything found
  PerLogAndDrive<double> floor;       ///< rms that no model can beat
  EffectSearch::State before, after;  ///< beside the base model, and beside the accepted effects
  std::shared_ptr<const EncoderPilots> pilots;
  NullStudy null;
  Omnibus omnibus_before, omnibus_after;
  VectorXd structure_before, structure_after;      ///< gains of the generic basis, one a drive
  std::vector<Fit> fits;                           ///< of the accepted effects
  std::vector<std::vector<EffectCandidate>> sets;  ///< what each could be besides
};

/// Motion, torque and rows of a log, with room for the residuals.
[[nodiscard]] DiagnosisTrace trace_of(const LogRows& log);

void say_too_short(double length_s, double needed_s, Diagnosis& out);

/// Steps 3 to 8 of the procedure.
/// \param earlier  a search in the same logs with nearly the same parameters, whose noise, encoder pilots and null are
///                 taken as they are
[[nodiscard]] SearchResult search_effects(const SearchContext& context, Diagnosis& out,
                                          const SearchResult* earlier = nullptr);

/// Fits and structure of every drive, and the list of all effects considered.
/// \param p,known  the model that the user gave
void describe_drives(const SearchContext& context, const SearchResult& found, const VectorXd& p,
                     const std::vector<Effect>& known, Diagnosis& out);

/// Steps 9 and 10: names, unknown structure, proof on the hold-out log.
/// \returns the largest share of a drive's noise variance that a name explains
double judge(const SearchContext& context, const SearchResult& found, const std::vector<Effect>& known, Diagnosis& out);

/// named, or confusable if one has a set.
[[nodiscard]] DiagnosisVerdict verdict_of(const std::vector<NamedEffect>& named);

/// Is it this effect at this place?
[[nodiscard]] bool is_of(const ConsideredEffect& one, const EffectCandidate& candidate);

/// Names and sets may have changed since the effects were ruled on: the rulings say what holds at the end.
void settle_rulings(Diagnosis& out);

/// "NAME at drive1 and OTHER at drive2", with this between them.
template <class Candidate>
[[nodiscard]] std::string listed(const std::vector<Candidate>& candidates, const char* between) {
  std::string text;
  for (const Candidate& one : candidates) text += (text.empty() ? "" : between) + one.at_joint();
  return text;
}

/// Drives that the effects reach.
[[nodiscard]] std::vector<int> reached_drives(const std::vector<NamedEffect>& named);
/// Root mean square over drives.
/// \param rms  of each drive
[[nodiscard]] double rms_over(const std::vector<int>& drives, const VectorXd& rms);

[[nodiscard]] bool turns(const Robot& robot, int drive);
/// Of its torque.
[[nodiscard]] const char* unit_of_drive(const Robot& robot, int drive);

/// Forgets how much of the gap on the hold-out log is closed.
void forget_gap(Diagnosis& out);

/// Does so large a share of a drive's noise variance, which no name explains, call for attention?
[[nodiscard]] bool is_overt(const Diagnosis& out, double largest_share);

/// A fit as a candidate: names, gain and its chance on clean logs.
[[nodiscard]] EffectCandidate candidate_of(const SearchContext& context, const SearchResult& found, const Fit& fit);

/// Step 7: everything that the data cannot tell from `best` beside the other effects.
/// \param state  beside the others
/// \param place  of `best` in `found`
[[nodiscard]] std::vector<EffectCandidate> confusable_set(const SearchContext& context, const SearchResult& found,
                                                          const EffectSearch::State& state, const Fit& best,
                                                          std::size_t place);

/// The verdict in words, and what to do next.
void say(const SearchContext& context, Diagnosis& out);

/// Of two diagnoses of the same logs in bands of different width, is `one` to be kept: does it name what `other` does
/// not, or leave less of the hold-out log (without one: of the structure) beside its names?
[[nodiscard]] bool explains_more(const Diagnosis& one, const Diagnosis& other);

/// Standard deviations of a fit's amplitudes and of its free shapes, fitted together: the larger of what the noise
/// model and what the residual's own blocks say, and beside it a share of the amplitude for the form of the column.
void set_uncertainty(const SearchContext& context, const EffectSearch::State& state, Fit& fit);

/// White rows of a segment in blocks of a quarter of a second, longer than what counts as memory of the noise: first
/// row and number.
[[nodiscard]] std::vector<std::pair<Index, Index>> row_blocks(const SearchContext& context,
                                                              const WhiteSegment& segment);

/// Rows a drive has on average: what the size of a gain is compared with.
[[nodiscard]] double rows_per_drive(const SearchContext& context, const WhiteProblem& problem);

/// What a re-fit of the problem's model leaves of a torque, in the rows of the logs [N m | N]: C a - [Y E] b for the b
/// that takes most, E the columns of the effects that the model holds.
struct Remainder {
  VectorXd beta;                    ///< b: base parameters, then amplitudes of the effects
  PerLogAndDrive<VectorXd> torque;  ///< [log][drive]; empty where there is none
};
/// \param columns  [log][drive] rows x k, empty where a drive is not reached
[[nodiscard]] Remainder remainder_of(const SearchContext& context, const WhiteProblem& problem,
                                     const PerLogAndDrive<MatrixXd>& columns, const VectorXd& amplitude);
/// Mean square of a remainder over the noise variance of each drive.
[[nodiscard]] VectorXd noise_shares(const SearchContext& context, const Remainder& remainder,
                                    const PerLogAndDrive<double>& floor);

/// What a re-fit of the problem's model leaves of an effect's white torque, in the problem's rows. The fit may be one
/// beside other effects.
[[nodiscard]] VectorXd remaining_torque(const WhiteProblem& problem, const Fit& fit);
/// Its squares, one value a drive: it also stands on drives that the effect itself does not reach.
[[nodiscard]] VectorXd remaining_squares_by_drive(const SearchContext& context, const WhiteProblem& problem,
                                                  const Fit& fit);

/// Ruling of an effect that the search has found.
inline constexpr const char* kFound = "found";
/// ... and of one of its set, before the name.
inline constexpr const char* kLikeAnother = "cannot be told from ";

/// Smallest share of a drive's noise variance that counts as an effect: below, a name would be of no use to anybody,
/// and plants that are clean for every purpose have traces of that size.
inline constexpr double kMaterial = 0.02;
/// The same for every effect beside the first.
inline constexpr double kMaterialFurther = 0.15;
/// The same for structure without a name: larger, as the basis is free enough to follow slow noise of one log for a
/// part.
inline constexpr double kMaterialStructure = 0.3;

/// Chance of the structure that counts as such.
inline constexpr double kStructureChance = 0.002;
/// rms over floor of a drive below which nothing is left to explain in the training logs.
inline constexpr double kOvertFloor = 1.1;

}  // namespace deltadyn::detail
