#include "judge.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <limits>
#include <optional>

#include "deltadyn/runtime/statistics.hpp"
#include "deltadyn/signal/reversal_mask.hpp"

#include "../search/ranking.hpp"
#include "../search/remainder.hpp"
#include "describe.hpp"
#include "holdout_proof.hpp"
#include "open_course.hpp"

namespace deltadyn::detail {

namespace {

constexpr double kInterval = 1.96;  // standard deviations on either side hold 95 %
constexpr double kRepeats = 0.05;   // of the hold-out residual's square that structure explains again if it is real
// Rms of the hold-out log over that of training, from which the machine itself may have changed
constexpr double kOtherMachine = 2.0;

/// What the generic basis still sees beside the names.
struct StructureLeft {
  double gain = 0;      ///< over what chance gives, all drives
  double worst = 0;     ///< clear of noise, over the noise variance of the drive of which most is left ...
  int drive = 0;        ///< ... and that drive
  bool counts = false;  ///< VerdictFacts::structure_counts
};

/// Share of the hold-out log's residual that the same function explains there; 1 without hold-out log.
double repeated_share(const SearchContext& context, const HoldoutProof* proof, std::size_t drive,
                      const VectorXd& coefficients, const VectorXd& beta) {
  if (proof == nullptr) return 1;
  const LogRows& held = *context.holdout;
  const VectorXd there =
      without_model(context.basis.columns.back()[drive] * coefficients, held.Y[drive], proof->effects[drive], beta);
  const VectorXd e = proof->after.col(static_cast<Index>(drive));
  const double before = root_mean_square(e, held.usable[drive]),
               after = root_mean_square(e - there, held.usable[drive]);
  return 1 - after * after / std::max(before * before, 1e-300);
}

StructureLeft structure_left(const SearchContext& context, const SearchResult& found, const HoldoutProof* proof) {
  const DiagnosisPolicy& policy = context.policy();
  const auto drives = static_cast<std::size_t>(context.robot.drives());
  StructureLeft out;
  for (std::size_t drive = 0; drive < drives; ++drive) {
    const auto j = static_cast<Index>(drive);
    const NullDistribution& null = found.null.omnibus[drive];
    out.gain += std::max(0.0, found.structure_after(j) - null.quantile(0.5));
    if (null.p_value(found.structure_after(j)) >= policy.structure_chance) continue;
    const VectorXd clear = found.omnibus_after.clear_part(*found.after.problem, drive);
    PerLogAndDrive<MatrixXd> columns(context.logs.size(), std::vector<MatrixXd>(drives));
    for (std::size_t l = 0; l < context.logs.size(); ++l) columns[l][drive] = context.basis.columns[l][drive];
    const Remainder structure = remainder_of(context, *found.after.problem, columns, clear);
    const double share = noise_shares(context, structure, found.floor)(j);
    if (share > out.worst) {
      out.worst = share;
      out.drive = static_cast<int>(drive);
    }
    // As large as the noise: more than slow noise of one log that the basis follows.
    out.counts |= share > 1 || (share > policy.material_structure &&
                                repeated_share(context, proof, drive, clear, structure.beta) > kRepeats);
  }
  return out;
}

/// Drives that bear at least a small share of the effect.
std::vector<int> drives_of(const SearchContext& context, const WhiteProblem& problem, const Fit& fit) {
  VectorXd energy = VectorXd::Zero(context.robot.drives());
  for (std::size_t s = 0; s < fit.white.blocks.size(); ++s) {
    if (fit.white.blocks[s].size() > 0)
      energy(static_cast<Index>(problem.segments[s].drive)) +=
          (fit.white.blocks[s] * fit.effect.amplitude).squaredNorm();
  }
  std::vector<int> out;
  for (Index j = 0; j < energy.size(); ++j) {
    if (energy(j) > context.policy().reached * energy.sum()) out.push_back(static_cast<int>(j));
  }
  return out;
}

/// Rates between which the effect does four fifths of its work.
void set_rates(const SearchContext& context, const Fit& fit, const WhiteProblem& problem, NamedEffect& one) {
  if (one.drives.empty()) return;
  const auto drive = static_cast<std::size_t>(one.drives.front());
  const VectorXd s = remaining_torque(problem, fit);
  std::vector<std::pair<double, double>> by_rate;  // |rate|, energy
  double whole = 0;
  for (const WhiteSegment& segment : problem.segments) {
    if (segment.drive != drive) continue;
    const auto& source = segment.whitener.source();
    for (std::size_t k = 0; k < source.size(); ++k) {
      const double e = s(segment.offset + static_cast<Index>(k));
      by_rate.emplace_back(std::abs(context.logs[segment.log].qd(source[k], static_cast<Index>(drive))), e * e);
      whole += e * e;
    }
  }
  std::sort(by_rate.begin(), by_rate.end());
  double sum = 0;
  for (const auto& [rate, e] : by_rate) {
    if (sum < 0.1 * whole) one.low_rate = rate;
    if (sum < 0.9 * whole) one.high_rate = rate;
    sum += e;
  }
}

/// Why a fit is none that a machine can have; nothing if it may be one.
std::optional<Remark> no_effect(const EffectCandidate& one, double cutoff_hz, const DiagnosisPolicy& policy) {
  const Effect& effect = one.effect;
  const bool may_be_nothing = effect.amplitude_std.size() == effect.amplitude.size() &&
                              (effect.amplitude.cwiseAbs().array() <= kInterval * effect.amplitude_std.array()).all();
  if (may_be_nothing) return Remark{.kind = Remark::Kind::may_be_nothing, .who = one.at_joint()};
  const EffectKind& kind = effect_kind(effect.id);
  if (kind.resonance_hz == nullptr) return std::nullopt;
  const double resonance_hz = kind.resonance_hz(effect.amplitude.data());
  if (resonance_hz > policy.resonance * cutoff_hz) return std::nullopt;
  return Remark{
      .kind = Remark::Kind::resonance_in_band, .who = one.at_joint(), .value = resonance_hz, .other = cutoff_hz};
}

/// An accepted effect and its set, without those that no machine can have, which are remarked on.
std::vector<EffectCandidate> possible_ones(const SearchContext& context, const SearchResult& found, const Fit& fit,
                                           Diagnosis& out) {
  std::vector<EffectCandidate> all = {candidate_of(context, found, fit)};
  all.insert(all.end(), fit.set.begin(), fit.set.end());
  std::erase_if(all, [&](const EffectCandidate& one) {
    const std::optional<Remark> reason = no_effect(one, out.cutoff_hz, context.policy());
    if (reason) out.remarks.push_back(*reason);
    return reason.has_value();
  });
  return all;
}

Remark hygiene_remark(const SearchContext& context, const SearchResult& found, const Fit& fit) {
  if (context.is_denied(fit.effect))
    return {.kind = Remark::Kind::not_on_holdout, .who = candidate_of(context, found, fit).at_joint()};
  return {.kind = near_rest(context, fit) ? Remark::Kind::rest_is_not_coulomb : Remark::Kind::about_a_sample,
          .who = context.search.hypotheses()[fit.hypothesis].joint_name(),
          .value = fit.effect.shape(0)};
}

/// What only some logs have belongs to them by their names: another command may give them in another order.
void name_logs(const SearchContext& context, const HoldoutProof* proof, Effect& effect) {
  if (!of_one_log(effect.id)) return;
  std::vector<std::string> all, loaded;
  for (const LogRows& log : context.logs) {
    all.push_back(bare_name(log.log.file));
    if (log.number == std::lround(effect.shape(0))) loaded.push_back(all.back());
  }
  if (context.holdout != nullptr) all.push_back(bare_name(context.holdout->log.file));
  if (proof != nullptr && proof->has_load) loaded.push_back(all.back());
  std::ranges::sort(all);
  if (std::ranges::adjacent_find(all) == all.end()) effect.logs = std::move(loaded);  // else names tell nothing
}

/// Accepted effects that a machine can have and the hold-out log asks for, too, into `out`.
/// \returns the largest share of a drive's noise variance that one of them explains
double name_effects(const SearchContext& context, const SearchResult& found, const HoldoutProof* proof, double all_gain,
                    Diagnosis& out) {
  double largest_share = 0, largest_gain = 0;
  for (const Fit& fit : found.fits) {
    if (!fit.hygiene) largest_gain = std::max(largest_gain, fit.gain);
  }
  for (const Fit& fit : found.fits) {
    if (fit.hygiene) {
      out.remarks.push_back(hygiene_remark(context, found, fit));
      continue;
    }
    if (proof != nullptr && fit.gain < largest_gain && !carries_over(context, found, *proof, fit)) {
      out.remarks.push_back(
          {.kind = Remark::Kind::not_on_holdout, .who = candidate_of(context, found, fit).at_joint()});
      continue;
    }
    std::vector<EffectCandidate> possible = possible_ones(context, found, fit, out);
    if (possible.empty()) continue;
    for (EffectCandidate& candidate : possible) name_logs(context, proof, candidate.effect);
    NamedEffect one;
    static_cast<EffectCandidate&>(one) = possible.front();
    one.gain_share = one.alike = 0;
    // An effect that was taken in beside others can have gained more alone than all of them together.
    const Remainder torque = remainder_of(context, *found.before.problem, fit.rows, fit.effect.amplitude);
    largest_share = std::max(largest_share, noise_shares(context, torque, found.floor).maxCoeff());
    one.explained_share = fit.gain / std::max({all_gain, fit.gain, 1e-300});
    one.confusable.assign(possible.begin() + 1, possible.end());
    one.drives = drives_of(context, *found.before.problem, fit);
    set_rates(context, fit, *found.before.problem, one);
    out.named.push_back(std::move(one));
  }
  std::ranges::sort(out.named, std::greater(), &NamedEffect::gain);
  return largest_share;
}

/// A drive whose residual is far above the noise of its own torque signal and, for the size of its torque, above that
/// of the other drives: the noise model can follow anything slow, but such a residual is not noise. -1: none.
int drive_with_slow_residual(const SearchContext& context, const Diagnosis& out) {
  const double pass_hz = context.processing.torque_cutoff_ratio * context.processing.cutoff_hz;
  std::vector<double> over_noise, over_torque;
  for (std::size_t j = 0; j < out.drives.size(); ++j) {
    double noise = 0, torque = 0;
    for (const LogRows& log : context.logs) {
      const auto tau = log.log.tau.col(static_cast<Index>(j));
      noise += position_noise(tau) * std::sqrt(std::min(1.0, 2 * pass_hz / log.log.rate_hz)) /
               static_cast<double>(context.logs.size());
      torque = std::max(torque, tau.cwiseAbs().maxCoeff());
    }
    over_noise.push_back(out.drives[j].rms_after / std::max(noise, 1e-300));
    over_torque.push_back(out.drives[j].rms_after / std::max(torque, 1e-300));
  }
  if (over_torque.size() < 2) return -1;
  const auto place = std::ranges::max_element(over_torque) - over_torque.begin();
  const auto worst = static_cast<std::size_t>(place);
  std::vector<double> others = over_torque;
  others.erase(others.begin() + place);
  const double over_others = over_torque[worst] / std::max(upper_median(std::move(others)), 1e-300);
  // Slow noise of all drives comes to 20 times the record's own noise and stands alike on all of them.
  const bool slow = over_others > 5 && over_noise[worst] * over_others > context.policy().slow_torque;
  return slow ? static_cast<int>(worst) : -1;
}

/// Of a drive on the hold-out log, if the model holds there as in training: what noise has left open in the parameters
/// shows in every other log.
double expected_rms(const HoldoutProof& proof, double rms_training, Index drive) {
  return std::hypot(std::max({rms_training, proof.floor(drive), 1e-300}), proof.unsure(drive));
}

/// The drive that misses the hold-out log although it fits the training logs; -1: none.
int missed_on_holdout(const SearchContext& context, const HoldoutProof& proof, const std::vector<DriveFit>& drives) {
  int out = -1;
  for (std::size_t drive = 0; drive < drives.size(); ++drive) {
    const auto j = static_cast<Index>(drive);
    const DriveFit& training = drives[drive];
    const double floor = std::max(proof.floor(j), 1e-300), here = proof.rms_before(j) / floor;
    // Slow noise makes the floor of one log look low: the residual itself must be larger than in training, too.
    const double expected = expected_rms(proof, training.rms, j);
    const double there = std::hypot(training.rms / std::max(training.floor, 1e-300), proof.unsure(j) / floor);
    const double gap = context.policy().holdout_gap;
    if (proof.rms_before(j) > gap * expected && here > gap * std::max(1.0, there)) out = static_cast<int>(drive);
  }
  return out;
}

/// Residuals of the hold-out log into `out`, and the gap of the names there.
void take_holdout(const SearchContext& context, const HoldoutProof& proof, Diagnosis& out, VerdictFacts& facts) {
  DiagnosisTrace trace = trace_of(*context.holdout);
  trace.holdout = true;
  trace.before = proof.before;
  trace.after = proof.after;
  out.traces.push_back(std::move(trace));
  for (std::size_t j = 0; j < out.drives.size(); ++j) {
    out.drives[j].rms_holdout = proof.rms_before(static_cast<Index>(j));
    out.drives[j].floor_holdout = proof.floor(static_cast<Index>(j));
  }
  for (NamedEffect& one : out.named) {
    one.rms_before = rms_over(one.drives, proof.rms_before);
    one.rms_after = rms_over(one.drives, proof.rms_after);
    one.rms_floor = rms_over(one.drives, proof.floor);
  }
  const std::vector<int> touched = reached_drives(out.named);
  if (touched.empty()) return;
  shrink_of(proof, *context.holdout, touched, context.options.seed, out);
  facts.gap_closed = out.gap_shrink;
  facts.gap_closed_at_most = out.gap_high;
  facts.holdout_gap = facts.holdout_left = 0;
  for (const int j : touched) {
    facts.holdout_gap = std::max(facts.holdout_gap, proof.rms_before(j) / std::max(proof.floor(j), 1e-300));
    const double training = out.drives[static_cast<std::size_t>(j)].rms_after;
    facts.holdout_left = std::max(facts.holdout_left, proof.rms_after(j) / expected_rms(proof, training, j));
  }
}

/// Without a hold-out log, before and after are those of the training logs.
void take_training(Diagnosis& out) {
  for (NamedEffect& one : out.named) {
    const DriveFit& drive = out.drives[static_cast<std::size_t>(one.drives.empty() ? 0 : one.drives.front())];
    one.rms_before = drive.rms;
    one.rms_after = drive.rms_after;
    one.rms_floor = drive.floor;
  }
  out.remarks.push_back({.kind = Remark::Kind::no_holdout});
}

/// Names whose course is open: they would be a guess beyond the logs' speeds. Others keep their place.
void leave_out_open_courses(const SearchContext& context, Diagnosis& out, VerdictFacts& facts) {
  std::vector<NamedEffect> closed;
  for (const NamedEffect& one : out.named) {
    const std::optional<Remark> open = open_course(context, one, out.gap_shrink);
    if (open) {
      out.remarks.push_back(*open);
    } else {
      closed.push_back(one);
    }
  }
  facts.open_courses = out.named.size() - closed.size();
  if (closed.empty()) return;  // the rules say what follows
  out.named = std::move(closed);
  facts.names = out.named.size();
  facts.open_courses = 0;
}

// What speaks against names, which are shown, but not added to the model.

void object_as_too_little(Diagnosis& out) {
  for (NamedEffect& one : out.named) one.objection = Objection::explains_too_little;
  if (out.named.empty()) return;
  out.remarks.push_back(
      {.kind = Remark::Kind::explains_a_part, .who = listed(out.named), .value = out.explained_share});
}

void object_as_denied(Diagnosis& out) {
  for (NamedEffect& one : out.named) one.objection = Objection::holdout_denies;
  out.remarks.push_back(
      {.kind = Remark::Kind::contradicted, .who = out.named.front().at_joint(), .value = out.gap_shrink});
  const DriveFit& drive = out.drives[static_cast<std::size_t>(out.place)];
  if (!(drive.rms_holdout > kOtherMachine * drive.rms)) return;
  out.remarks.push_back(
      {.kind = Remark::Kind::machine_changed, .drive = out.place, .value = drive.rms_holdout, .other = drive.rms});
}

void forget_gap(Diagnosis& out) {
  out.gap_shrink = out.gap_low = out.gap_high = std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

VerdictFacts facts_of(const SearchContext& context, const SearchResult& found, const std::vector<Effect>& known,
                      Diagnosis& out) {
  VerdictFacts facts;
  std::optional<HoldoutProof> proof;
  if (context.holdout != nullptr) proof = prove(context, found, *context.holdout, known);
  const HoldoutProof* held = proof ? &*proof : nullptr;
  const StructureLeft left = structure_left(context, found, held);
  const double gain = std::max(0.0, found.before.problem->r.squaredNorm() - found.after.problem->r.squaredNorm());
  facts.explained_share = out.explained_share = gain > 0 ? gain / (gain + left.gain) : 0.0;
  facts.structure_left = left.worst;
  facts.structure_counts = left.counts;
  out.place = left.drive;
  const double largest_share = name_effects(context, found, held, gain + left.gain, out);
  facts.names = out.named.size();
  out.p_value = out.named.empty() ? found.null.omnibus.p_value(found.structure_before) : out.named.front().p_value;
  const auto above = [&](const DriveFit& drive) {
    return drive.rms > context.policy().overt_floor * std::max(drive.floor, 1e-300);
  };
  facts.overt = largest_share > context.policy().material_structure && std::ranges::any_of(out.drives, above);
  forget_gap(out);
  if (held != nullptr) {
    take_holdout(context, *held, out, facts);
    facts.missed_drive = missed_on_holdout(context, *held, out.drives);
  } else {
    take_training(out);
  }
  if (gives_a_name(deciding_rule(facts, context.policy()).verdict)) leave_out_open_courses(context, out, facts);
  facts.sets = std::ranges::any_of(out.named, [](const NamedEffect& one) { return !one.confusable.empty(); });
  facts.slow_drive = drive_with_slow_residual(context, out);
  facts.base_hidden = found.before.problem->Q.cols() < context.base.count() + amplitude_count(known);
  return facts;
}

void decide(const VerdictFacts& facts, const DiagnosisPolicy& policy, Diagnosis& out) {
  const VerdictRule& rule = deciding_rule(facts, policy);
  out.reason = rule.reason;
  out.verdict = rule.verdict;
  out.facts = facts;
  const std::vector<int> touched = reached_drives(out.named);
  switch (rule.reason) {
    case VerdictReason::names_explain_too_little:
    case VerdictReason::structure_without_name: object_as_too_little(out); break;
    case VerdictReason::holdout_contradicts_names:
      out.place = touched.front();
      object_as_denied(out);
      break;
    case VerdictReason::slow_torque: out.place = facts.slow_drive; break;
    case VerdictReason::course_open: out.place = touched.empty() ? -1 : touched.front(); break;
    case VerdictReason::holdout_moves_elsewhere: out.place = facts.missed_drive; break;
    case VerdictReason::holdout_too_short:
    case VerdictReason::written_model_refused: out.place = touched.empty() ? -1 : touched.front(); break;
    default: out.place = -1;
  }
  const bool objected = !out.named.empty() && out.named.front().objection != Objection::none;
  const bool denied = !hold_on_holdout(facts, policy) || facts.written == WrittenModelIs::no_better;
  if (denied) {
    for (const NamedEffect& one : out.named) out.denied.push_back(one.effect);
  }
  if (gives_a_name(out.verdict) || objected || out.named.empty()) return;
  if (!hold_on_holdout(facts, policy)) {
    out.remarks.push_back(
        {.kind = Remark::Kind::trace_makes_worse, .who = out.named.front().at_joint(), .value = out.gap_shrink});
  }
  out.named.clear();
  forget_gap(out);
}

void withdraw_names(const std::vector<Effect>& known, Diagnosis& out) {
  out.improved.reset();
  out.effects = known;
  out.explained_share = 0;
}

std::vector<int> reached_drives(const std::vector<NamedEffect>& named) {
  std::vector<int> out;
  for (const NamedEffect& one : named) {
    for (const int j : one.drives) {
      if (std::ranges::count(out, j) == 0) out.push_back(j);
    }
  }
  return out;
}

double rms_over(const std::vector<int>& drives, const VectorXd& rms) {
  return root_mean_square(rms(drives));
}

std::string listed(const std::vector<NamedEffect>& named) {
  std::string text;
  for (const NamedEffect& one : named) text += (text.empty() ? "" : " and ") + one.at_joint();
  return text;
}

bool explains_more(const Diagnosis& one, const Diagnosis& other) {
  const bool name = gives_a_name(one.verdict), other_name = gives_a_name(other.verdict);
  if (!name || !other_name) return name && !other_name;
  const bool held = !one.holdout_figures.empty() && one.holdout_figures.size() == other.holdout_figures.size();
  if (!held) return one.explained_share > other.explained_share;
  // Squares of the hold-out residual beside the names, each drive in units of `other`'s residual without them.
  const auto left = [&](const Diagnosis& diagnosis) {
    double sum = 0;
    for (std::size_t j = 0; j < diagnosis.holdout_figures.size(); ++j) {
      const double given = other.holdout_figures[j].rms_given, written = diagnosis.holdout_figures[j].rms_written;
      if (given > 0) sum += written * written / (given * given);
    }
    return sum;
  };
  return left(one) < left(other);
}

}  // namespace deltadyn::detail
