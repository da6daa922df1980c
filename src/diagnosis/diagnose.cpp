#include "deltadyn/diagnosis/diagnose.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <set>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/signal/reversal_mask.hpp"

#include "evidence/prepare_rows.hpp"
#include "verdict/describe.hpp"
#include "verdict/written_trial.hpp"

namespace deltadyn {

const char* verdict_name(DiagnosisVerdict verdict) {
  switch (verdict) {
    case DiagnosisVerdict::nothing_missing: return "nothing-missing";
    case DiagnosisVerdict::named: return "named";
    case DiagnosisVerdict::confusable: return "confusable";
    case DiagnosisVerdict::unknown_structure: return "unknown-structure";
    case DiagnosisVerdict::not_testable: return "not-testable";
  }
  return "";
}

const char* reason_name(VerdictReason reason) {
  switch (reason) {
    case VerdictReason::logs_too_short: return "logs-too-short";
    case VerdictReason::names_explain_too_little: return "names-explain-too-little";
    case VerdictReason::structure_without_name: return "structure-without-name";
    case VerdictReason::holdout_contradicts_names: return "holdout-contradicts-names";
    case VerdictReason::slow_torque: return "slow-torque";
    case VerdictReason::course_open: return "course-open";
    case VerdictReason::holdout_moves_elsewhere: return "holdout-moves-elsewhere";
    case VerdictReason::base_parameters_hidden: return "base-parameters-hidden";
    case VerdictReason::nothing_counts: return "nothing-counts";
    case VerdictReason::holdout_too_short: return "holdout-too-short";
    case VerdictReason::written_model_refused: return "written-model-refused";
    case VerdictReason::not_borne_out: return "not-borne-out";
    case VerdictReason::several_names_fit: return "several-names-fit";
    case VerdictReason::one_name_fits: return "one-name-fits";
  }
  return "";
}

void DiagnosisOptions::validate() const {
  const auto refuse = [](const char* field, const char* range) {
    throw Error(std::string("the option is out of range; ") + range, field, "choose a value in the range",
                ExitCode::usage);
  };
  processing.validate();
  if (!(false_naming_rate > 0 && false_naming_rate < 0.5))
    refuse("--false-naming-rate", "it must be above 0 and below 0.5");
  if (max_effects < 1 || max_effects > 6) refuse("--max-effects", "it must be 1 to 6");
  if (null_runs < 20 || null_runs > 100000) refuse("--null-runs", "it must be 20 to 100000");
  if (!processing.filter) {
    throw Error("the diagnosis filters every log alike, whatever columns it has", "--no-filter", "leave the flag out",
                ExitCode::usage);
  }
}

namespace {

constexpr int kMostPasses = 3;        // of the search with parameters that are better each time ...
constexpr double kSameSize = 0.003;   // ... until no amplitude changes by more than this share
constexpr double kLeastKnown = 0.5;   // of a drive's rows beside reversals: with less, the low pass is too narrow
constexpr int kMostDenied = 3;        // names that the hold-out log may speak against
constexpr double kSameBristle = 0.1;  // of a displacement: a change that moves no row

/// Positions and torques of every sample, to be compared as they are.
std::set<std::vector<double>> samples_of(const Log& log) {
  std::set<std::vector<double>> out;
  for (Index k = 0; k < log.samples(); ++k) {
    std::vector<double> one(log.q.row(k).begin(), log.q.row(k).end());
    one.insert(one.end(), log.tau.row(k).begin(), log.tau.row(k).end());
    out.insert(std::move(one));
  }
  return out;
}

/// Is most of the second log in the first? Single samples may be alike by chance, at rest.
bool holds_most_of(const Log& log, const Log& part) {
  if (log.q.cols() != part.q.cols()) return false;
  const std::set<std::vector<double>> samples = samples_of(log), of_part = samples_of(part);
  const auto shared =
      std::count_if(of_part.begin(), of_part.end(), [&](const auto& one) { return samples.count(one) > 0; });
  return 2 * shared > static_cast<std::ptrdiff_t>(of_part.size());
}

/// Have two searches found the same effects, in the same sizes?
bool settled(const detail::SearchResult& last, const detail::SearchResult& found) {
  if (last.fits.size() != found.fits.size()) return false;
  for (std::size_t k = 0; k < found.fits.size(); ++k) {
    const Effect &before = last.fits[k].effect, &now = found.fits[k].effect;
    if (before.id != now.id || before.joint != now.joint) return false;
    if ((before.amplitude - now.amplitude).norm() > kSameSize * now.amplitude.norm()) return false;
  }
  return true;
}

/// Torque of friction near reversals and of ripples, as two fits found it: do their rows differ?
/// \param masked  drives whose rows near reversals are left out: there the bristle is no matter
bool extras_differ(const ProcessingOptions& one, const ProcessingOptions& other, const std::vector<int>& masked) {
  if (one.ripples.size() != other.ripples.size() || one.presliding.size() != other.presliding.size()) return true;
  for (Index joint = 0; joint < one.presliding.size(); ++joint) {
    if (std::count(masked.begin(), masked.end(), static_cast<int>(joint)) > 0) continue;
    const double change = std::abs(one.presliding(joint) - other.presliding(joint));
    if (change > kSameBristle * std::max(one.presliding(joint), other.presliding(joint))) return true;
  }
  return false;
}

void refuse_training_log(const std::vector<Log>& logs, const Log& holdout) {
  for (const Log& log : logs) {
    if (holds_most_of(log, holdout)) {
      throw Error("the hold-out log is one of the training logs (" + log.file + ") or cut from it", holdout.file,
                  "hold out a log that takes no part in the search, else it proves nothing", ExitCode::usage);
    }
  }
}

/// The search in its rows, which bristles and ripples that turn out otherwise change.
class DiagnosisRun {
 public:
  DiagnosisRun(const detail::DiagnosisInput& input, Diagnosis& out)
      : in_(input),
        out_(out),
        wanted_(input.options.processing),
        base_(find_base_parameters(input.robot)),
        model_(input.robot),
        p_fit_(input.p) {}

  /// \param cutoff_hz  of the search; 0: chosen from the logs
  /// \returns false if the logs are too short, which then is said
  bool prepare(double cutoff_hz) {
    for (const Log& log : in_.logs) out_.length_s += static_cast<double>(log.samples()) * log.sample_time_s();
    double widest_hz = 0;
    if (wanted_.periods == Periods::given) out_.remarks.push_back({.kind = Remark::Kind::periods_not_averaged});
    try {
      detail::SearchCutoff cutoff{wanted_.cutoff_hz, wanted_.cutoff_hz, wanted_.cutoff_hz};
      if (cutoff_hz > 0) {
        cutoff = {cutoff_hz, cutoff_hz, cutoff_hz};
      } else if (in_.options.choose_cutoff) {
        // A delay, which the search weighs, must not end the band in which the model holds.
        cutoff = detail::search_cutoff(rules(), in_.training.beside({}), in_.options.threads);
      }
      out_.cutoff_hz = cutoff.chosen_hz;
      widest_hz = cutoff.widest_hz;
      report(0.05);
      take_fixed_effects_off();
      use_cutoff(out_.cutoff_hz);
      if (cutoff.widest_hz > out_.cutoff_hz && (fewest_.share < kLeastKnown || too_few())) use_cutoff(cutoff.widest_hz);
      if (cutoff.sharp_hz > out_.cutoff_hz && too_few()) use_cutoff(cutoff.sharp_hz);
    } catch (const Error& error) {
      if (std::string(error.problem()).find("too short") == std::string::npos) throw;
      set_too_short(std::max(10.0, 4 * out_.length_s));
      return false;
    }
    // Rows enough to fit the base model and still see something beside it?
    if (too_few()) {
      set_too_short(1.2 * out_.length_s * rows_needed() / std::max(fewest_.count, 1.0));
      return false;
    }
    p_fit_ = refit_parameters(base_, rows_.logs, in_.p);
    if (widest_hz > in_.options.policy.wider_band * out_.cutoff_hz) wider_hz_ = widest_hz;
    return true;
  }

  /// Cut-off of a band clearly wider than the one of the search that noise leaves to the logs; 0: there is none.
  [[nodiscard]] double wider_hz() const { return wider_hz_; }

  void search() {
    set_up();
    report(0.15);
    found_ = detail::search_effects(context());
    // Loads, torques and tilts were those of a model that had to make up for what is missing: again with the better
    // one. So were bristles and ripples: where they turn out otherwise, the rows are new, too.
    for (int pass = 0; pass < kMostPasses && !found_.fits.empty(); ++pass) {
      p_fit_ = closest_parameters(base_, found_.after.problem->beta.head(base_.count()), in_.p);
      const bool new_rows = pass == 0 && find_extras_anew();
      if (new_rows) make_rows();
      set_up();
      const detail::SearchResult last = std::move(found_);
      found_ = detail::search_effects(context(), new_rows ? nullptr : &last);
      if (!new_rows && settled(last, found_)) break;
    }
    report(0.9);
  }

  /// A trace that the hold-out log speaks against may cover what is missing: it is allowed for, and the search goes on
  /// beside it.
  void name() {
    Diagnosis first = named();
    Diagnosis last = first;
    for (int k = 0; k < kMostDenied && last.verdict == DiagnosisVerdict::nothing_missing && !last.denied.empty(); ++k) {
      denied_.push_back(last.denied.front());
      const detail::SearchResult before = std::move(found_);
      found_ = detail::search_effects(context(), &before);
      last = named();
    }
    out_ = gives_a_name(last.verdict) ? std::move(last) : std::move(first);
  }

 private:
  /// What follows from the search.
  [[nodiscard]] Diagnosis named() const {
    Diagnosis out = out_;
    const detail::SearchContext now = context();
    out.encoder_share = found_.null.encoder_share;
    detail::describe_drives(now, found_, in_.p, known_, out);
    detail::list_considered(now, found_, out);
    for (const int joint : masked_) out.remarks.push_back({.kind = Remark::Kind::bristle_left_out, .drive = joint});
    const VerdictFacts facts = detail::facts_of(now, found_, known_, out);
    detail::decide(facts, in_.options.policy, out);
    detail::improve_and_prove(input(), facts, out);
    detail::settle_rulings(out);
    return out;
  }

  void report(double share) const {
    if (in_.options.progress) in_.options.progress(share);
  }

  void use_cutoff(double cutoff_hz) {
    out_.cutoff_hz = cutoff_hz;
    judge_bristles(known_);
    make_rows();
    fewest_ = detail::fewest_rows(rows_.logs);
  }

  void set_too_short(double needed_s) {
    out_.verdict = DiagnosisVerdict::not_testable;
    out_.reason = VerdictReason::logs_too_short;
    out_.needed_s = needed_s;
  }

  [[nodiscard]] detail::RowRules rules() const { return {in_.robot, base_, wanted_, in_.options.policy}; }
  [[nodiscard]] bool too_few() const { return fewest_.count < rows_needed(); }
  [[nodiscard]] double rows_needed() const {
    return std::max(120.0, in_.options.policy.rows_per_parameter * base_.count());
  }

  detail::TrialInput input() const { return {in_, p_fit_, wanted_, masked_, out_.cutoff_hz}; }

  /// Known effects whose shape is their amplitude are taken off at once, the others are fitted along.
  void take_fixed_effects_off() {
    std::vector<Effect> fixed;
    for (const Effect& effect : in_.known)
      (effect_kind(effect.id).tied || !effect.logs.empty() ? fixed : known_).push_back(effect);
    logs_ = without_effects(in_.robot, in_.logs, in_.p, fixed, motion_hz());
    if (in_.holdout != nullptr)
      held_log_ = without_effects(in_.robot, {*in_.holdout}, in_.p, fixed, motion_hz()).front();
    for (const Log& log : logs_) {
      position_noises_.emplace_back();
      for (Index j = 0; j < log.q.cols(); ++j) position_noises_.back().push_back(position_noise(log.q.col(j)));
    }
  }

  void make_rows() {
    rows_ = detail::prepare_rows(rules(), logs_, held_log_ ? &*held_log_ : nullptr, out_.cutoff_hz, masked_);
  }

  /// \param effects  that were found by now
  void judge_bristles(const std::vector<Effect>& effects) {
    masked_ = detail::drives_without_hold(
        rules(), model_, without_effects(in_.robot, logs_, p_fit_, effects, motion_hz()), out_.cutoff_hz, p_fit_);
  }

  double motion_hz() const { return wanted_.motion_over_pass * out_.cutoff_hz; }

  void set_up() {
    for (std::vector<LogRows>* group : {&rows_.logs, &rows_.held}) {
      for (LogRows& log : *group) log.signals = model_.signals(log.log, p_fit_);
    }
    basis_ = make_generic_basis(rows_.logs, rows_.held);
    search_ = std::make_unique<EffectSearch>(model_, rows_.logs, basis_, known_, rows_.processing.presliding);
  }

  detail::SearchContext context() const {
    detail::SearchContext context{in_.robot,   model_,           base_, rows_.logs, basis_, *search_,
                                  in_.options, rows_.processing, p_fit_};
    context.holdout = rows_.held.empty() ? nullptr : &rows_.held.front();
    context.position_noise = position_noises_;
    context.denied = denied_;
    return context;
  }

  /// Bristles and ripples beside what has been found. True if the rows change.
  bool find_extras_anew() {
    if (!(wanted_.presliding.array() > 0).any() && wanted_.ripples.empty()) return false;
    std::vector<Effect> effects = in_.known;
    for (const Fit& fit : found_.fits) effects.push_back(fit.effect);
    const ProcessingOptions before = wanted_;
    const std::vector<int> masked_before = masked_;
    try {
      detail::take_extras(detail::identify_beside(input(), in_.logs, effects, false).processing, wanted_);
    } catch (const Error&) {
      return false;  // a provisional model that cannot be fitted says nothing about bristles: they stay
    }
    std::vector<Effect> fitted = known_;  // the others are off these logs already
    for (const Fit& fit : found_.fits) fitted.push_back(fit.effect);
    judge_bristles(fitted);
    return masked_ != masked_before || extras_differ(before, wanted_, masked_);
  }

  const detail::DiagnosisInput& in_;
  Diagnosis& out_;
  ProcessingOptions wanted_;  ///< with the bristles and ripples that are known by now
  BaseParameters base_;
  EffectModel model_;
  VectorXd p_fit_;
  double wider_hz_ = 0;
  std::vector<int> masked_;    ///< drives whose bristles do not hold
  std::vector<Effect> known_;  ///< those that are fitted along
  std::vector<Log> logs_;
  std::optional<Log> held_log_;
  PerLogAndDrive<double> position_noises_;
  detail::DiagnosisRows rows_;
  detail::KnownRows fewest_;  ///< of the rows that the band was chosen by
  GenericBasis basis_;
  std::unique_ptr<EffectSearch> search_;
  detail::SearchResult found_;
  std::vector<Effect> denied_;  ///< names that the hold-out log has spoken against
};

}  // namespace

Diagnosis diagnose(const Robot& robot, const std::vector<Log>& logs, const Log* holdout, const VectorXd& p,
                   const VectorXd& p_std, const std::vector<Effect>& known, const DiagnosisOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  options.validate();
  if (logs.empty()) throw Error("there is no log", "", "give at least one log file", ExitCode::usage);
  if (holdout != nullptr) refuse_training_log(logs, *holdout);
  const detail::ValidatedLogs training(robot, logs),
      held(robot, holdout != nullptr ? std::vector<Log>{*holdout} : std::vector<Log>());
  const detail::GivenModel given(robot, held, detail::written_model(p, known, options.processing), options);
  const detail::DiagnosisInput input{robot, logs, holdout, p, p_std, known, options, training, given};
  double wider_hz = 0;
  const auto search = [&](double cutoff_hz) {
    Diagnosis out;
    out.null_runs = options.null_runs;
    out.effects = known;
    out.gap_shrink = out.gap_low = out.gap_high = std::numeric_limits<double>::quiet_NaN();
    DiagnosisRun run(input, out);
    if (run.prepare(cutoff_hz)) {
      wider_hz = run.wider_hz();
      run.search();
      run.name();
    }
    return out;
  };
  Diagnosis out = search(0);
  // What is missing can end the band in which the model holds, and be told in a wider one only.
  if (wider_hz > 0) {
    Diagnosis wide = search(wider_hz);
    if (detail::explains_more(wide, out)) out = std::move(wide);
  }
  out.total_time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (options.progress) options.progress(1);
  return out;
}

}  // namespace deltadyn
