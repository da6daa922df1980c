#include "ranking.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace deltadyn::detail {

namespace {

constexpr double kSamples = 1.0;  // a skew or lag up to one sample is a matter of who samples when, not of the robot

/// Does a rich effect lie so near its special case that only the form of the law can have parted them?
bool nearly_special(const Fit& rich) {
  const EffectKind& kind = effect_kind(rich.effect.id);
  return kind.nearly_special != nullptr && kind.nearly_special(rich.effect.amplitude.data());
}

}  // namespace

std::vector<std::size_t> best_of(const EffectSearch& search, const EffectSearch::State& state, std::size_t count) {
  std::vector<std::size_t> order(state.scores.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return search.worth(a, state.scores[a].gain, state) > search.worth(b, state.scores[b].gain, state);
  });
  order.resize(std::min(count, order.size()));
  order.erase(std::remove_if(order.begin(), order.end(), [&](std::size_t h) { return !(state.scores[h].gain > 0); }),
              order.end());
  return order;
}

bool holds(EffectId rich, EffectId simple) {
  const auto& cases = effect_kind(rich).special_cases;
  return std::find(cases.begin(), cases.end(), effect_kind(simple).name) != cases.end();
}

std::size_t simpler_one(const EffectSearch& search, const std::vector<Fit>& fits, const std::vector<double>& gains,
                        std::size_t best) {
  const Hypothesis& winner = search.hypotheses()[fits[best].hypothesis];
  const double enough = nearly_special(fits[best]) ? 0.0 : winner.kind().simpler_gain * gains[best];
  std::optional<std::size_t> simpler;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const Hypothesis& other = search.hypotheses()[fits[k].hypothesis];
    if (other.joint != winner.joint || !holds(winner.id, other.id) || gains[k] < enough) continue;
    if (!simpler || gains[k] > gains[*simpler]) simpler = k;
  }
  return simpler.value_or(best);
}

std::optional<Fit> best_fit(const EffectSearch& search, const EffectSearch::State& state,
                            const std::function<bool(const Fit&)>& counts) {
  double best_worth = 0;
  std::size_t best = 0;
  std::vector<Fit> fits;
  std::vector<double> gains;
  const auto order = best_of(search, state, kRefined);
  search.refine_all(state, order);
  for (const std::size_t h : order) {
    Fit fit = search.refine(state, h);
    if (!counts(fit)) continue;
    const double worth = search.worth(h, fit.gain, state);
    if (fits.empty() || worth > best_worth) {
      best_worth = worth;
      best = fits.size();
    }
    gains.push_back(fit.gain);
    fits.push_back(std::move(fit));
  }
  if (fits.empty()) return std::nullopt;
  return std::move(fits[simpler_one(search, fits, gains, best)]);
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
  const EffectKind& kind = effect_kind(fit.effect.id);
  return kind.effect_class == EffectClass::phase && kind.tied &&
         std::abs(fit.effect.shape(0)) * context.logs.front().log.rate_hz <= kSamples;
}

}  // namespace deltadyn::detail
