#include "search_effects.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "deltadyn/runtime/in_parallel.hpp"

#include "form_error.hpp"
#include "ranking.hpp"
#include "remainder.hpp"

namespace deltadyn::detail {

namespace {

constexpr int kHygienic = 4;  // further ones that may be needed for what counts as hygiene only
constexpr std::size_t kProvisionalCandidates = 6;
constexpr std::size_t kBestForPairs = 10;
constexpr int kMostExchanges = 3;  // of one name for another, at the end

/// The effect that raises the likelihood most when the noise is estimated again beside it, among the best by their gain
/// with and without the noise's memory. None if no effect raises it enough.
std::optional<Fit> most_likely(const SearchContext& context, const EncoderPilots& pilots,
                               const std::vector<Fit>& provisional, const NoiseEstimate& estimate) {
  const EffectSearch& search = context.search;
  std::vector<Fit> candidates;
  // Smooth effects, which an autoregression takes for noise, show in noise without memory.
  for (const auto& noise : {estimate.noise, without_memory(estimate.noise)}) {
    const EffectSearch::State state = search.state(noise, provisional, &pilots);
    const auto order = best_of(search, state, kProvisionalCandidates);
    search.refine_all(state, order);
    for (const std::size_t h : order) candidates.push_back(search.refine(state, h));
  }
  double rows = 0;
  for (const LogRows& log : context.logs) {
    for (const RowMask& usable : log.usable) rows += static_cast<double>(usable.count());
  }
  // All start from the same noise and take one pass, the model without a further effect, too.
  const double reference = search.noise_beside(provisional, &estimate.noise).log_likelihood;
  std::vector<double> gain(candidates.size(), 0.0);
  in_parallel(candidates.size(), [&](std::size_t k) {
    std::vector<Fit> with = provisional;
    with.push_back(candidates[k]);
    gain[k] = 2 * (search.noise_beside(with, &estimate.noise).log_likelihood - reference) -
              search.hypotheses()[candidates[k].hypothesis].freedom() * std::log(rows);
  });
  const auto best = static_cast<std::size_t>(std::max_element(gain.begin(), gain.end()) - gain.begin());
  if (gain.empty() || gain[best] <= context.policy().provisional_gain) return std::nullopt;
  return std::move(candidates[simpler_one(search, context.policy(), candidates, gain, best)]);
}

/// \param material  smallest share of the noise variance
bool counts(const SearchContext& context, const SearchResult& found, const EffectSearch::State& state, const Fit& fit,
            double material) {
  const double grid = std::min(fit.grid_gain, fit.gain);
  if (fit.gain < context.policy().material * rows_per_drive(context, *state.problem)) return false;
  // Slow noise hides slow torques, so that a quick trace far below the noise can gain much.
  const Remainder torque = remainder_of(context, *state.problem, fit.rows, fit.effect.amplitude);
  if (noise_shares(context, torque, found.floor).sum() < material) return false;
  return found.null.hypotheses.p_value(fit.hypothesis, grid) <= context.options.false_naming_rate;
}

EffectSearch::State beside_others(const SearchContext& context, const SearchResult& found, std::size_t k) {
  std::vector<Fit> others = found.fits;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
  return context.search.state(found.noise, others, found.pilots.get());
}

Fit fit_beside(const SearchContext& context, const SearchResult& found, const EffectSearch::State& others,
               std::size_t k) {
  const Fit& fit = context.search.refine(others, found.fits[k].hypothesis);
  if (!found.fits[k].hygiene || hygienic(context, fit)) return fit;
  Fit allowed = found.fits[k];  // no more than was allowed for without a name
  allowed.white = others.problem->whiten(allowed.rows);
  return allowed;
}

/// The hypothesis that fits better than `fit` in its place, now that the others are known; `fit` if there is none.
Fit best_in_place(const SearchContext& context, const SearchResult& found, const EffectSearch::State& others,
                  std::size_t k, Fit fit) {
  if (found.fits[k].hygiene) return fit;
  const FormErrors form_errors(context, found, others, k);
  const auto named = std::ranges::count(found.fits, false, &Fit::hygiene);
  const double material = named > 1 ? context.policy().material_further : context.policy().material;
  const auto may_follow = [&](const Fit& one) {
    return !hygienic(context, one) && counts(context, found, others, one, material) && !form_errors.explain(one);
  };
  const std::optional<Fit> best = best_fit(context, others, may_follow);
  const bool better =
      best && context.search.worth(best->hypothesis, best->gain, others) >
                  context.search.worth(fit.hypothesis, fit.gain, others) + context.policy().exchange_worth;
  return better ? *best : fit;
}

/// Takes out the weakest of the effects that no longer count beside the others, or that the others' forms can have
/// left: the first of several may have been a mixture of them. False if there is none.
bool drop_weakest(const SearchContext& context, SearchResult& found) {
  std::optional<std::size_t> weakest;
  double least = 0;
  for (std::size_t k = 0; k < found.fits.size() && found.fits.size() > 1; ++k) {
    const EffectSearch::State others = beside_others(context, found, k);
    const Fit fit = fit_beside(context, found, others, k);
    if (weakest && fit.gain >= least) continue;
    const FormErrors form_errors(context, found, others, k);
    if (counts(context, found, others, fit, context.policy().material) &&
        (found.fits[k].hygiene || !form_errors.explain(fit)))
      continue;
    weakest = k;
    least = fit.gain;
  }
  if (!weakest) return false;
  found.fits.erase(found.fits.begin() + static_cast<std::ptrdiff_t>(*weakest));
  return true;
}

/// Another hypothesis in the place of effect k, if one fits better now that the others are known.
void exchange(const SearchContext& context, SearchResult& found, std::size_t k) {
  if (found.fits[k].hygiene) return;
  const EffectSearch::State others = beside_others(context, found, k);
  const Fit now = fit_beside(context, found, others, k);
  Fit best = best_in_place(context, found, others, k, now);
  if (best.hypothesis != now.hypothesis) found.fits[k] = std::move(best);
}

/// The best effect beside those found, as long as one counts.
void take_in_forward(const SearchContext& context, SearchResult& found) {
  const EffectSearch& search = context.search;
  std::optional<EffectSearch::State> beside;
  int named = 0;
  while (named < context.options.max_effects &&
         static_cast<int>(found.fits.size()) < context.options.max_effects + kHygienic) {
    const EffectSearch::State& state = beside ? *beside : found.before;
    const FormErrors form_errors(context, found, state);
    std::optional<Fit> fit = best_fit(context, state, [&](const Fit& one) {
      return counts(context, found, state, one,
                    named > 0 ? context.policy().material_further : context.policy().material) &&
             !form_errors.explain(one);
    });
    if (!fit) break;
    fit->hygiene = hygienic(context, *fit);
    named += fit->hygiene ? 0 : 1;
    found.fits.push_back(std::move(*fit));
    // An earlier one may have stood for a mixture with the newest: what such a mixture leaves must not be taken for a
    // third.
    for (std::size_t k = 0; k + 1 < found.fits.size(); ++k) exchange(context, found, k);
    beside = search.state(found.noise, found.fits, found.pilots.get());
  }
}

/// The first of two may have been a mixture of both: the best pair, if it gains clearly more than the best single and
/// its follower.
void prefer_the_best_pair(const SearchContext& context, SearchResult& found) {
  const EffectSearch& search = context.search;
  if (found.fits.size() != 2 || found.fits[0].hygiene || found.fits[1].hygiene) return;
  const EffectSearch::Pair pair = search.best_pair(found.before, kBestForPairs);
  const double forward_gain =
      found.before.problem->r.squaredNorm() - search.state(found.noise, found.fits, nullptr).problem->r.squaredNorm();
  const auto taken = [&](std::size_t h) { return found.fits[0].hypothesis == h || found.fits[1].hypothesis == h; };
  if (pair.gain <= 1.02 * forward_gain || (taken(pair.first) && taken(pair.second))) return;
  found.fits.clear();
  for (const std::size_t h : {pair.first, pair.second}) {
    const EffectSearch::State beside = search.state(found.noise, found.fits, found.pilots.get());
    found.fits.push_back(search.refine(beside, h));
    found.fits.back().hygiene = hygienic(context, found.fits.back());
  }
}

/// Each must still count beside the others; then its shape, size and set beside them, again where one has given way to
/// another.
void settle_backward(const SearchContext& context, SearchResult& found) {
  bool exchanged = true;
  for (int pass = 0; exchanged && pass < kMostExchanges; ++pass) {
    while (drop_weakest(context, found)) {
    }
    exchanged = false;
    for (std::size_t k = 0; k < found.fits.size(); ++k) {
      const EffectSearch::State others = beside_others(context, found, k);
      Fit fit = best_in_place(context, found, others, k, fit_beside(context, found, others, k));
      exchanged |= fit.hypothesis != found.fits[k].hypothesis;
      fit.hygiene = found.fits[k].hygiene || hygienic(context, fit);
      set_uncertainty(context, others, fit);
      fit.set = fit.hygiene ? std::vector<EffectCandidate>() : confusable_set(context, found, others, fit, k);
      found.fits[k] = std::move(fit);
    }
  }
}

}  // namespace

double rows_per_drive(const SearchContext& context, const WhiteProblem& problem) {
  return static_cast<double>(problem.freedom) / static_cast<double>(context.logs.front().usable.size());
}

SearchResult search_effects(const SearchContext& context, const SearchResult* earlier) {
  const EffectSearch& search = context.search;
  const DiagnosisOptions& options = context.options;
  SearchResult found;
  const auto report = [&](double share) {
    if (options.progress) options.progress(share);
  };

  // Encoder noise: which scores it fakes. With the noise model of the base model; a large effect in it only makes this
  // coarser.
  if (earlier != nullptr) {
    found.noise = earlier->noise;
    found.floor = earlier->floor;
    found.pilots = earlier->pilots;
    report(0.3);
  } else {
    NoiseEstimate estimate = search.noise_beside({});
    const EffectSearch::State state = search.state(estimate.noise, {}, nullptr);
    const double pass_hz = std::min(context.processing.torque_cutoff_ratio * context.processing.cutoff_hz,
                                    0.4 * context.logs.front().log.rate_hz);
    found.pilots = std::make_shared<EncoderPilots>(context.model, context.base, context.logs, context.p, *state.problem,
                                                   search.hypotheses(), state.signatures, context.position_noise,
                                                   context.processing.cutoff_hz, pass_hz, options);
    report(0.3);
    // Provisional effects, so that the noise model is not made of what is missing.
    std::vector<Fit> provisional;
    for (int step = 0; step < options.max_effects + kHygienic; ++step) {
      std::optional<Fit> fit = most_likely(context, *found.pilots, provisional, estimate);
      if (!fit) break;
      provisional.push_back(std::move(*fit));
      estimate = search.noise_beside(provisional);
      report(0.3 + 0.03 * (step + 1));
    }
    found.noise = std::move(estimate.noise);
    found.floor = std::move(estimate.floor_rms);
  }
  const EncoderPilots& pilots = *found.pilots;

  // The null, beside the base model, with that noise.
  found.before = search.state(found.noise, {}, &pilots);
  found.omnibus_before = Omnibus(*found.before.problem, context.basis);
  found.structure_before = found.omnibus_before.gains(*found.before.problem);
  if (earlier != nullptr) {
    found.null = earlier->null;
  } else {
    found.null =
        run_null_study(pilots, *found.before.problem, search.hypotheses(), found.before.signatures, found.before.bias,
                       found.omnibus_before, options, [&](double share) { report(0.45 + 0.4 * share); });
  }

  take_in_forward(context, found);
  prefer_the_best_pair(context, found);
  settle_backward(context, found);
  found.after = search.state(found.noise, found.fits, &pilots);
  found.omnibus_after = Omnibus(*found.after.problem, context.basis);
  found.structure_after = found.omnibus_after.gains(*found.after.problem);
  return found;
}

}  // namespace deltadyn::detail
