#include "written_trial.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn::detail {

namespace {

constexpr double kSameWaves = 0.1;  // of a ripple's waves: two are the same
constexpr double kSettled = 0.1;    // change of an amplitude that least squares without noise model may make

/// Names, the model with them, and its proof.
struct Trial {
  std::vector<NamedEffect> named;
  std::vector<Effect> effects;  ///< of the model: those it had and the named ones
  Identification improved;
  WrittenProof proof;
};

/// Amplitudes from the same least squares as the parameters, so that both belong together; where encoder noise in the
/// column makes them come out small, or rows near reversals belong to it that follow no law, those of the search stay.
void settle_amplitudes(const TrialInput& input, const std::vector<Log>& logs, Trial& trial) {
  const std::vector<Effect> settled =
      estimate_amplitudes(input.robot, logs, input.p_fit, trial.effects, trial.improved);
  for (std::size_t k = 0; k < settled.size(); ++k) {
    Effect& effect = trial.effects[k];
    const VectorXd change = settled[k].amplitude - effect.amplitude;
    if (effect.amplitude_std.size() != change.size()) effect.amplitude_std = settled[k].amplitude_std;
    const bool masked = std::count(input.masked.begin(), input.masked.end(), effect.joint) > 0;
    if (!masked && change.norm() <= kSettled * effect.amplitude.norm()) {
      effect.amplitude = settled[k].amplitude;
      if (effect_kind(effect.id).tied) effect.shape(0) = effect.amplitude(0);
      effect.amplitude_std = effect.amplitude_std.cwiseMax(change.cwiseAbs());
    }
    for (NamedEffect& one : trial.named) {
      if (one.effect.id == effect.id && one.effect.joint == effect.joint) one.effect = effect;
    }
  }
}

void fit_improved(const TrialInput& input, bool keep_extras, Trial& trial) {
  trial.effects = input.known;
  for (const NamedEffect& one : trial.named) trial.effects.push_back(one.effect);
  // As delta-identify takes the logs: a delay that no effect explains is no part of the model.
  const std::vector<Log>& logs = input.training.beside(trial.effects);
  trial.improved = identify_beside(input, logs, trial.effects, keep_extras);
  settle_amplitudes(input, logs, trial);
  trial.improved = identify_beside(input, logs, trial.effects, keep_extras);
}

/// Fits the model with the names, with bristles found anew and, if that is not borne out, with those of the search.
Trial try_names(const TrialInput& input, const std::vector<NamedEffect>& named) {
  const ProcessingOptions& own = input.extras;
  const bool has_extras = (own.presliding.array() > 0).any() || !own.ripples.empty();
  Trial best;
  for (const bool keep_extras : {false, true}) {
    if (keep_extras && (!has_extras || best.proof.passed())) break;
    Trial trial;
    trial.named = named;
    fit_improved(input, keep_extras, trial);
    trial.proof =
        input.given.compare_with(written_model(trial.improved.fit.p, trial.effects, trial.improved.processing),
                                 reached_drives(named), input.cutoff_hz);
    if (!keep_extras || trial.proof.passed()) best = std::move(trial);
  }
  return best;
}

/// A name with another of its set in its place, and itself in the set.
NamedEffect swapped(NamedEffect one, std::size_t alternative) {
  EffectCandidate own = one;
  std::swap(static_cast<EffectCandidate&>(one), one.confusable[alternative]);
  one.confusable[alternative] = std::move(own);
  return one;
}

/// Parameters that a fit spends on an effect. A choice of a few is none: it bends to no data.
int freedom(const Effect& effect) {
  const EffectKind& kind = effect_kind(effect.id);
  const auto moves = [](const ShapeTraits& shape) { return shape.scale != ShapeScale::choice; };
  const auto shapes = std::count_if(kind.shapes.begin(), kind.shapes.end(), moves);
  return static_cast<int>(kind.amplitudes.size()) + static_cast<int>(shapes) - (kind.tied ? 1 : 0);
}

/// What the hold-out log says to one name and those that the training logs cannot tell from it: the one that it bears
/// out, and of those the simplest. Alternatives of one name only, as those of several grow with their product.
Trial try_set(const TrialInput& input, const NamedEffect& named) {
  Trial best = try_names(input, {named});
  const bool alone = best.proof.passed();
  std::vector<std::size_t> refused;
  for (std::size_t k = 0; k < named.confusable.size(); ++k) {
    const bool simpler = freedom(named.confusable[k].effect) < freedom(best.named.front().effect);
    if (alone && !simpler) continue;
    Trial other;
    try {
      other = try_names(input, {swapped(named, k)});
    } catch (const Error& error) {
      if (error.code() != ExitCode::no_convergence) throw;
      continue;  // neither borne out nor refused: it stays in the set
    }
    if (!other.proof.passed()) {
      refused.push_back(k);
    } else if (!best.proof.passed() ||
               input.options.policy.clearly_better * other.proof.rms_ratio < best.proof.rms_ratio) {
      best = std::move(other);
    }
  }
  if (!best.proof.passed()) return best;
  // The set is what the hold-out log leaves of it.
  std::vector<EffectCandidate>& set = best.named.front().confusable;
  const auto is_out = [&](const EffectCandidate& one) {
    const bool first = one.effect.id == named.effect.id && one.effect.joint == named.effect.joint;
    return (first && !alone) || std::any_of(refused.begin(), refused.end(), [&](std::size_t k) {
             const Effect& out = named.confusable[k].effect;
             return out.id == one.effect.id && out.joint == one.effect.joint;
           });
  };
  std::erase_if(set, is_out);
  for (EffectCandidate& one : set) {
    if (one.gain_share == 0) one.objection = Objection::no_better_with_more_parameters;
  }
  return best;
}

/// What the proof said against the names.
Remark refusal(const Trial& trial) {
  const std::vector<int> touched = reached_drives(trial.named);
  const int j = trial.proof.worse_drive >= 0 ? trial.proof.worse_drive : (touched.empty() ? 0 : touched.front());
  const HoldoutFigure& figure = trial.proof.drives[static_cast<std::size_t>(j)];
  return {.kind = Remark::Kind::refused,
          .who = listed(trial.named),
          .drive = j,
          .value = figure.rms_written,
          .other = figure.rms_given};
}

/// The figures that stand in the diagnosis are those of the written model.
void take(Trial trial, bool identify, Diagnosis& out) {
  out.named = std::move(trial.named);
  out.effects = std::move(trial.effects);
  if (identify) out.improved = std::move(trial.improved);
  out.holdout_figures = trial.proof.drives;
  out.holdout_cutoff_hz = trial.proof.cutoff_hz;
  if (out.holdout_figures.empty()) return;
  VectorXd given(std::ssize(out.holdout_figures)), written = given;
  for (Index j = 0; j < given.size(); ++j) {
    given(j) = out.holdout_figures[static_cast<std::size_t>(j)].rms_given;
    written(j) = out.holdout_figures[static_cast<std::size_t>(j)].rms_written;
  }
  for (NamedEffect& one : out.named) {
    one.rms_before = rms_over(one.drives, given);
    one.rms_after = rms_over(one.drives, written);
    one.rms_floor = std::min(one.rms_floor, one.rms_after);
  }
}

/// Known ripples that were not found again and that no effect stands for.
std::vector<Ripple> lost_ripples(const std::vector<Ripple>& found, const std::vector<Ripple>& known,
                                 const std::vector<Effect>& effects) {
  const auto near = [](double one, double other) { return std::abs(one - other) < kSameWaves * std::abs(other); };
  std::vector<Ripple> lost = known;
  std::erase_if(lost, [&](const Ripple& ripple) {
    return std::any_of(found.begin(), found.end(),
                       [&](const Ripple& one) { return one.drive == ripple.drive && near(one.n, ripple.n); }) ||
           std::any_of(effects.begin(), effects.end(), [&](const Effect& one) {
             return one.id == effect_with(Role::wave) && one.joint == ripple.drive && near(one.shape(0), ripple.n);
           });
  });
  return lost;
}

Effect effect_of(const Ripple& ripple) {
  return {effect_with(Role::wave),
          ripple.drive,
          VectorXd::Constant(1, ripple.n),
          Eigen::Vector2d(ripple.cosine, ripple.sine),
          {},
          {}};
}

}  // namespace

void take_extras(const ProcessingOptions& from, ProcessingOptions& to) {
  to.presliding = from.presliding;
  to.presliding_damping_s = from.presliding_damping_s;
  to.ripples = from.ripples;
}

Identification identify_beside(const TrialInput& input, const std::vector<Log>& logs,
                               const std::vector<Effect>& effects, bool keep_extras) {
  IdentificationOptions identification;
  identification.processing = input.options.processing;
  identification.processing.cutoff_hz = input.cutoff_hz;
  identification.choose_cutoff = false;
  identification.threads = input.options.threads;
  const double motion_hz = identification.processing.motion_over_pass * input.cutoff_hz;
  const VectorXd& prior = input.options.prior.size() > 0 ? input.options.prior : input.p;
  const std::vector<Log> rest = without_effects(input.robot, logs, input.p_fit, effects, motion_hz);
  if (keep_extras) {
    take_extras(input.extras, identification.processing);
    identification.reversals = Reversals::mask;
  } else {
    take_extras({}, identification.processing);
  }
  Identification out = identify(input.robot, rest, prior, input.p_std, identification);
  // Beside other structure a ripple is not claimed anew: known ones stay, their torque taken off before the fit.
  const std::vector<Ripple> lost =
      keep_extras ? std::vector<Ripple>() : lost_ripples(out.processing.ripples, input.extras.ripples, effects);
  if (!lost.empty()) {
    std::vector<Effect> waves;
    for (const Ripple& ripple : lost) waves.push_back(effect_of(ripple));
    out = identify(input.robot, without_effects(input.robot, rest, input.p_fit, waves, motion_hz), prior, input.p_std,
                   identification);
    out.processing.ripples.insert(out.processing.ripples.end(), lost.begin(), lost.end());
  }
  if (keep_extras) {
    // Bristles that were not looked for have their values from the search.
    for (const double displacement : out.processing.presliding) {
      PreslidingJoint joint;
      joint.displacement = displacement;
      out.presliding.push_back(joint);
    }
    for (Index j = 0; j < std::min<Index>(out.processing.presliding_damping_s.size(), out.processing.presliding.size());
         ++j)
      out.presliding[static_cast<std::size_t>(j)].damping_s = out.processing.presliding_damping_s(j);
  }
  return out;
}

void improve_and_prove(const TrialInput& input, VerdictFacts facts, Diagnosis& out) {
  out.effects = input.known;
  if (!gives_a_name(out.verdict)) return;
  for (const NamedEffect& one : out.named) out.effects.push_back(one.effect);
  try {
    if (input.holdout == nullptr) {
      Trial trial;
      trial.named = out.named;
      if (!input.options.identify) return;
      fit_improved(input, false, trial);
      take(std::move(trial), true, out);
      return;
    }
    for (std::vector<NamedEffect> named = out.named; !named.empty(); named.pop_back()) {
      Trial trial = named.size() == 1 ? try_set(input, named.front()) : try_names(input, named);
      if (trial.proof.passed()) {
        facts.written = WrittenModelIs::better;
        facts.sets = std::ranges::any_of(trial.named, [](const NamedEffect& one) { return !one.confusable.empty(); });
        take(std::move(trial), input.options.identify, out);
        break;
      }
      facts.written = trial.proof.testable() ? WrittenModelIs::no_better : WrittenModelIs::not_testable;
      if (facts.written == WrittenModelIs::not_testable) {
        const std::vector<int> touched = reached_drives(trial.named);
        const HoldoutFigure& figure =
            trial.proof.drives[static_cast<std::size_t>(touched.empty() ? 0 : touched.front())];
        out.holdout_rows = std::min(figure.rows_given, figure.rows_written);
        out.remarks.push_back({.kind = Remark::Kind::too_few_rows, .who = listed(trial.named)});
        break;
      }
      out.remarks.push_back(refusal(trial));
    }
  } catch (const Error& error) {
    out.remarks.push_back({.kind = Remark::Kind::not_identified, .who = error.problem()});
    facts.written = WrittenModelIs::no_better;
  }
  if (facts.written != WrittenModelIs::better) withdraw_names(input.known, out);
  decide(facts, input.options.policy, out);
}

}  // namespace deltadyn::detail
