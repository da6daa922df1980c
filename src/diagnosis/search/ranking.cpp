#include "ranking.hpp"

#include <algorithm>
#include <cmath>

namespace deltadyn::detail {

namespace {

/// Does a rich effect lie so near its special case that only the form of the law can have parted them?
bool nearly_special(const Fit& rich) {
  const EffectKind& kind = effect_kind(rich.effect.id);
  return kind.nearly_special != nullptr && kind.nearly_special(rich.effect.amplitude.data());
}

}  // namespace

std::vector<std::size_t> best_of(const EffectSearch& search, const EffectSearch::State& state, std::size_t count) {
  std::vector<std::size_t> order = search.ranked(state, count);
  std::erase_if(order, [&](std::size_t h) { return !(state.scores[h].gain > 0); });
  return order;
}

bool holds(EffectId rich, EffectId simple) {
  const auto& cases = effect_kind(rich).special_cases;
  return std::find(cases.begin(), cases.end(), effect_kind(simple).name) != cases.end();
}

std::size_t simpler_one(const EffectSearch& search, const DiagnosisPolicy& policy, const std::vector<Fit>& fits,
                        const std::vector<double>& gains, std::size_t best) {
  const Hypothesis& winner = search.hypotheses()[fits[best].hypothesis];
  const double enough = nearly_special(fits[best]) ? 0.0 : winner.kind().simpler_gain * gains[best];
  std::optional<std::size_t> simpler;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const Hypothesis& other = search.hypotheses()[fits[k].hypothesis];
    if (other.joint != winner.joint || !holds(winner.id, other.id) || gains[k] < enough) continue;
    if (!simpler || gains[k] > gains[*simpler]) simpler = k;
  }
  if (simpler) return *simpler;
  const auto freedom = [&](std::size_t k) { return search.hypotheses()[fits[k].hypothesis].freedom(); };
  for (std::size_t k = 0; k < fits.size(); ++k) {
    if (freedom(k) + kFewer > freedom(best) || gains[k] < (1 - policy.set_form) * gains[best]) continue;
    if (!simpler || freedom(k) < freedom(*simpler) || (freedom(k) == freedom(*simpler) && gains[k] > gains[*simpler]))
      simpler = k;
  }
  return simpler.value_or(best);
}

std::optional<Fit> best_fit(const SearchContext& context, const EffectSearch::State& state,
                            const std::function<bool(const Fit&)>& counts) {
  const EffectSearch& search = context.search;
  std::vector<Fit> fits;
  std::vector<double> gains, worths;
  const auto order = best_of(search, state, kRefined);
  search.refine_all(state, order);
  for (const std::size_t h : order) {
    const Fit& fit = search.refine(state, h);
    if (!counts(fit)) continue;
    gains.push_back(fit.gain);
    worths.push_back(search.worth(h, fit.gain, state));
    fits.push_back(fit);
  }
  if (fits.empty()) return std::nullopt;
  const auto best = static_cast<std::size_t>(std::ranges::max_element(worths) - worths.begin());
  return std::move(fits[simpler_one(search, context.policy(), fits, gains, best)]);
}

bool near_rest(const SearchContext& context, const Fit& fit) {
  const EffectKind& kind = effect_kind(fit.effect.id);
  if (kind.only_near_rest == nullptr) return false;
  double largest = 0;
  for (const LogRows& log : context.logs)
    largest = std::max(largest, log.qd.col(fit.effect.joint).cwiseAbs().maxCoeff());
  return kind.only_near_rest(fit.effect.shape.data(), largest);
}

bool hygienic(const SearchContext& context, const Fit& fit) {
  if (near_rest(context, fit)) return true;
  if (context.is_denied(fit.effect)) return true;
  const EffectKind& kind = effect_kind(fit.effect.id);
  return kind.effect_class == EffectClass::phase && kind.tied &&
         std::abs(fit.effect.shape(0)) * context.logs.front().log.rate_hz <= context.policy().hygiene_samples;
}

}  // namespace deltadyn::detail
