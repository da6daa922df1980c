#include "ranking.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace deltadyn::detail {

namespace {

constexpr double kSimplerGain =
    0.95;  // share of the best one's gain for which an effect is preferred that it holds as a special case
constexpr double kSameLoss = 0.5;     // smaller over larger loss of a gear from which both count as one
constexpr double kSkewSamples = 1.0;  // a skew up to one sample is a matter of who samples when, not of the robot
constexpr double kRestShare = 0.03;   // of the largest rate: friction that bends below it is friction at rest
constexpr double kLagSamples = 1.0;   // and so is so short a lag

/// Does a rich effect lie so near its special case that only the form of the catalogue can have parted them? Losses that depend on the
/// direction hardly differ less than by a factor of two.
bool nearly_special(const Fit& rich) {
  if (rich.effect.id != EffectId::directional_efficiency) return false;
  const double driving = rich.effect.amplitude(0), back_driving = rich.effect.amplitude(1);
  return std::min(driving, back_driving) > kSameLoss * std::max(driving, back_driving);
}

bool near_rest(const SearchContext& context, const Fit& fit) {
  if (fit.effect.id != EffectId::shear_thinning || fit.effect.shape(1) > 0) return false;
  double largest = 0;
  for (const LogRows& log : context.logs) largest = std::max(largest, log.qd.col(fit.effect.joint).cwiseAbs().maxCoeff());
  return fit.effect.shape(0) < kRestShare * largest;
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
  return (rich == EffectId::directional_efficiency && simple == EffectId::load_dependent_friction) ||
         (rich == EffectId::limb_inertia_mismatch && simple == EffectId::rotor_inertia);
}

std::optional<Fit> best_fit(const EffectSearch& search, const EffectSearch::State& state,
                            const std::function<bool(const Fit&)>& counts) {
  std::optional<Fit> best, simpler;
  double best_worth = 0;
  std::vector<Fit> fits;
  const auto order = best_of(search, state, kRefined);
  search.refine_all(state, order);
  for (const std::size_t h : order) {
    Fit fit = search.refine(state, h);
    if (!counts(fit)) continue;
    const double worth = search.worth(h, fit.gain, state);
    if (!best || worth > best_worth) {
      best_worth = worth;
      best = fit;
    }
    fits.push_back(std::move(fit));
  }
  if (!best) return best;
  // The forms of the catalogue are not exact: a richer one must not win by following what is wrong with a simpler one.
  const auto& hypotheses = search.hypotheses();
  const Hypothesis& winner = hypotheses[best->hypothesis];
  for (Fit& fit : fits) {
    const Hypothesis& other = hypotheses[fit.hypothesis];
    if (other.joint != winner.joint || !holds(winner.id, other.id)) continue;
    if (fit.gain < kSimplerGain * best->gain && !nearly_special(*best)) continue;
    if (!simpler || fit.gain > simpler->gain) simpler = std::move(fit);
  }
  return simpler ? simpler : best;
}

bool hygienic(const SearchContext& context, const Fit& fit) {
  if (near_rest(context, fit)) return true;
  const double samples = fit.effect.shape.size() > 0 ? std::abs(fit.effect.shape(0)) * context.logs.front().log.rate_hz : 0.0;
  if (fit.effect.id == EffectId::time_skew) return samples <= kSkewSamples;
  return fit.effect.id == EffectId::current_lag && samples <= kLagSamples;
}

}  // namespace deltadyn::detail
