#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>

#include "form_error.hpp"

namespace deltadyn::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kProvisional = 20;  // gain that lets an effect into the noise model before the null is known
constexpr int kHygienic = 4;         // further ones that may be needed for what counts as hygiene only
constexpr std::size_t kProvisionalCandidates = 6;
constexpr double kMaterialFurther = 0.15;  // kMaterial of every effect beside the first
constexpr double kSimplerGain =
    0.95;  // share of the best one's gain for which an effect is preferred that it holds as a special case
constexpr double kSameLoss = 0.5;  // smaller over larger loss of a gear from which both count as one
constexpr std::size_t kBestForPairs = 10;
constexpr std::size_t kRefined = 8;     // hypotheses whose shapes are refined before they are compared
constexpr double kBetter = 2.0;         // worth that another hypothesis must have more than one that was taken before
constexpr double kSetLikelihood = 3.0;  // standard deviations of the likelihood ratio beyond which an alternative is out
constexpr double kSetBootstrap = 2.0;   // the same for the block bootstrap
constexpr double kSetForm = 0.02;       // share of the gain that the forms of the catalogue cannot be trusted to tell
constexpr double kClearShare = 0.2;  // of a gain, on drives that no other effect reaches, from which these alone tell names apart
constexpr double kSkewSamples = 1.0;  // a skew up to one sample is a matter of who samples when, not of the robot
constexpr double kRestShare = 0.03;   // of the largest rate: friction that bends below it is friction at rest
constexpr double kLagSamples = 1.0;   // and so is so short a lag

std::vector<std::size_t> by_worth(const EffectSearch& search, const EffectSearch::State& state) {
  std::vector<std::size_t> order(state.scores.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return search.worth(a, state.scores[a].gain, state) > search.worth(b, state.scores[b].gain, state);
  });
  return order;
}

/// Is the second effect the first one with fewer parameters?
bool holds(EffectId rich, EffectId simple) {
  return (rich == EffectId::directional_efficiency && simple == EffectId::load_dependent_friction) ||
         (rich == EffectId::limb_inertia_mismatch && simple == EffectId::rotor_inertia);
}

/// Does a rich effect lie so near its special case that only the form of the catalogue can have parted them? Losses that depend on the
/// direction hardly differ less than by a factor of two.
bool nearly_special(const Fit& rich) {
  if (rich.effect.id != EffectId::directional_efficiency) return false;
  const double driving = rich.effect.amplitude(0), back_driving = rich.effect.amplitude(1);
  return std::min(driving, back_driving) > kSameLoss * std::max(driving, back_driving);
}

/// The hypothesis that is worth most once shapes are refined, among those that `counts` lets pass: the best one may be noise that
/// the null knows, and must not stand in the way of the next.
std::optional<Fit> best_fit(const EffectSearch& search, const EffectSearch::State& state,
                            const std::function<bool(const Fit&)>& counts = {}) {
  std::optional<Fit> best, simpler;
  double best_worth = 0;
  std::vector<Fit> fits;
  const auto order = by_worth(search, state);
  for (std::size_t k = 0; k < std::min(kRefined, order.size()); ++k) {
    if (!(state.scores[order[k]].gain > 0)) continue;
    Fit fit = search.refine(state, order[k]);
    if (counts && !counts(fit)) continue;
    const double worth = search.worth(order[k], fit.gain, state);
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

/// The same noise without its memory: smooth effects, which an autoregression takes for noise, show in it.
PerLogAndDrive<NoiseModel> without_memory(PerLogAndDrive<NoiseModel> noise) {
  for (auto& log : noise) {
    for (NoiseModel& one : log) {
      one.std = one.total_std();
      one.ar.resize(0);
    }
  }
  return noise;
}

/// The effect that raises the likelihood most when the noise is estimated again beside it, among the best by their gain with and
/// without the noise's memory. None if no effect raises it enough.
std::optional<Fit> most_likely(const SearchContext& context, const EncoderPilots& pilots,
                               const std::vector<AcceptedEffect>& provisional, const NoiseEstimate& estimate) {
  const EffectSearch& search = context.search;
  std::vector<Fit> candidates;
  for (const auto& noise : {estimate.noise, without_memory(estimate.noise)}) {
    const EffectSearch::State state = search.state(noise, provisional, &pilots);
    const auto order = by_worth(search, state);
    for (std::size_t k = 0; k < std::min(kProvisionalCandidates, order.size()); ++k) {
      if (state.scores[order[k]].gain > 0) candidates.push_back(search.refine(state, order[k]));
    }
  }
  const double rows = [&] {
    double sum = 0;
    for (const LogRows& log : context.logs) {
      for (const RowMask& usable : log.usable) sum += static_cast<double>(usable.count());
    }
    return sum;
  }();
  // All start from the same noise and take one pass, the model without a further effect, too.
  const double reference = search.noise_beside(provisional, &estimate.noise).log_likelihood;
  std::vector<double> gain(candidates.size(), 0.0);
#pragma omp parallel for schedule(dynamic)
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    std::vector<AcceptedEffect> with = provisional;
    with.push_back(search.accept(candidates[k]));
    gain[k] = 2 * (search.noise_beside(with, &estimate.noise).log_likelihood - reference) -
              search.hypotheses()[candidates[k].hypothesis].freedom() * std::log(rows);
  }
  std::optional<Fit> best;
  double most = kProvisional;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (gain[k] <= most) continue;
    most = gain[k];
    best = candidates[k];
  }
  return best;
}

bool near_rest(const SearchContext& context, const Fit& fit) {
  if (fit.effect.id != EffectId::shear_thinning || fit.effect.shape(1) > 0) return false;
  double largest = 0;
  for (const LogRows& log : context.logs) largest = std::max(largest, log.qd.col(fit.effect.joint).cwiseAbs().maxCoeff());
  return fit.effect.shape(0) < kRestShare * largest;
}

/// What is corrected without a name: a skew of about a sample, and Coulomb's law that is smoothed near rest.
bool hygienic(const SearchContext& context, const Fit& fit) {
  if (near_rest(context, fit)) return true;
  const double samples = fit.effect.shape.size() > 0 ? std::abs(fit.effect.shape(0)) * context.logs.front().log.rate_hz : 0.0;
  if (fit.effect.id == EffectId::time_skew) return samples <= kSkewSamples;
  return fit.effect.id == EffectId::current_lag && samples <= kLagSamples;
}

/// Sum of squared differences a block of a quarter of a second: how robust is a gain?
double block_std(const SearchContext& context, const WhiteProblem& problem, const VectorXd& difference) {
  std::vector<double> blocks;
  for (const WhiteSegment& segment : problem.segments) {
    for (const auto& [first, count] : row_blocks(context, segment)) blocks.push_back(difference.segment(first, count).sum());
  }
  const double mean = std::accumulate(blocks.begin(), blocks.end(), 0.0) / static_cast<double>(blocks.size());
  double square = 0;
  for (const double b : blocks) square += (b - mean) * (b - mean);
  return std::sqrt(square);
}

EffectCandidate candidate_of(const SearchContext& context, const SearchResult& found, const Fit& fit) {
  const Hypothesis& hypothesis = context.search.hypotheses()[fit.hypothesis];
  EffectCandidate out;
  out.effect = fit.effect;
  out.name = hypothesis.name();
  out.effect_class = hypothesis.kind().effect_class;
  out.joint = hypothesis.joint_name();
  out.gain = fit.gain;
  out.p_value = found.null.family_p(fit.hypothesis, fit.grid_gain);
  return out;
}

/// Drives that bear a tenth or more of one of the other effects: there, what its form leaves may decide between two names.
std::vector<bool> reached_by_others(const SearchContext& context, const SearchResult& found, std::size_t but) {
  std::vector<bool> out(static_cast<std::size_t>(context.robot.drives()), false);
  for (std::size_t k = 0; k < found.fits.size(); ++k) {
    if (k == but) continue;
    const VectorXd theirs = remaining_squares_by_drive(context, *found.before.problem, found.fits[k]);
    for (Index j = 0; j < theirs.size(); ++j) {
      if (theirs(j) > 0.1 * theirs.sum()) out[static_cast<std::size_t>(j)] = true;
    }
  }
  return out;
}

/// Lead of one name over another as a share of its gain, by the drives that no other effect reaches; infinite if these gain too little.
/// \param worse,better  squares by which the other name, and no name, is worse in each row
double clear_lead(const WhiteProblem& problem, const std::vector<bool>& reached, const VectorXd& worse, const VectorXd& better,
                  double least_gain) {
  double lead = 0, gain = 0;
  for (const WhiteSegment& segment : problem.segments) {
    if (reached[segment.drive]) continue;
    lead += worse.segment(segment.offset, segment.rows()).sum();
    gain += better.segment(segment.offset, segment.rows()).sum();
  }
  return gain > least_gain ? lead / gain : std::numeric_limits<double>::infinity();
}

/// Everything that the data cannot tell from `best` beside the other effects (step 7). \param place  of `best` in `found`
std::vector<EffectCandidate> confusable_set(const SearchContext& context, const SearchResult& found,
                                            const EffectSearch::State& state, const Fit& best, std::size_t place) {
  std::vector<EffectCandidate> set;
  const std::vector<bool> reached = reached_by_others(context, found, place);
  const WhiteProblem& problem = *state.problem;
  const Index k = best.effect.amplitude.size();
  if (best.white.cols < k) return set;
  const MatrixXd C_best = best.white.projected(problem.Q, problem.segments, 0, k);
  const VectorXd s_best = C_best * best.effect.amplitude;
  const VectorXd r_best = problem.r - s_best;
  const double best_worth = context.search.worth(best.hypothesis, best.gain, state);
  const auto order = by_worth(context.search, state);
  std::size_t looked_at = 0;
  for (const std::size_t h : order) {
    if (h == best.hypothesis) continue;
    if (++looked_at > kRefined || state.scores[h].gain < 0.5 * best.gain) break;
    const Fit other = context.search.refine(state, h);
    const Index m = other.effect.amplitude.size();
    if (other.white.cols < m || hygienic(context, other)) continue;
    const VectorXd s_other = other.white.projected(problem.Q, problem.segments, 0, m) * other.effect.amplitude;
    // Were `other` the truth, how likely would `best` win by so much? Its own direction is what the shapes' freedom leaves.
    const VectorXd coefficients =
        (C_best.transpose() * C_best).completeOrthogonalDecomposition().solve(C_best.transpose() * s_other);
    const double distance = (s_other - C_best * coefficients).norm();
    const double lead = best_worth - context.search.worth(h, other.gain, state);
    const double z = (lead + distance * distance) / std::max(2 * distance, 1e-9);
    const VectorXd r_other = problem.r - s_other;
    const double spread = block_std(context, problem, r_other.cwiseAbs2() - r_best.cwiseAbs2());
    const double raw_lead = r_other.squaredNorm() - r_best.squaredNorm();
    const bool alike = z < kSetLikelihood;
    const bool by_blocks = raw_lead < kSetBootstrap * spread && z < 2 * kSetLikelihood;
    // An effect with more parameters would have followed a form that the catalogue lacks better, not worse.
    const Hypothesis& one = context.search.hypotheses()[best.hypothesis];
    const Hypothesis& alternative = context.search.hypotheses()[h];
    const double clear = clear_lead(problem, reached, r_other.cwiseAbs2() - r_best.cwiseAbs2(),
                                    problem.r.cwiseAbs2() - r_best.cwiseAbs2(), kClearShare * best.gain);
    const bool by_form = clear < 0 || (std::min(lead / best.gain, clear) < kSetForm && alternative.freedom() <= one.freedom());
    if (!alike && !by_blocks && !by_form) continue;
    // Beside its own special case an effect is no alternative: the case would have to be met by chance.
    if (alternative.joint == one.joint && holds(alternative.id, one.id)) continue;
    EffectCandidate candidate = candidate_of(context, found, other);
    const double cosine = std::abs(s_best.dot(s_other)) / std::max(s_best.norm() * s_other.norm(), 1e-300);
    candidate.why =
        fmt::format("it explains {:.1f} % of what {} explains; in these motions their torques are alike to {:.1f} %",
                    100 * other.gain / std::max(best.gain, 1e-300), candidate_of(context, found, best).name, 100 * cosine);
    set.push_back(std::move(candidate));
  }
  return set;
}

/// \param material  smallest share of the noise variance
bool counts(const SearchContext& context, const SearchResult& found, const EffectSearch::State& state, const Fit& fit,
            double material = kMaterial) {
  const double grid = std::min(fit.grid_gain, fit.gain);
  if (fit.gain < kMaterial * rows_per_drive(context, *state.problem)) return false;
  // Slow noise hides slow torques, so that a quick trace far below the noise can gain much.
  const Remainder torque = remainder_of(context, *state.problem, fit.rows, fit.effect.amplitude);
  if (noise_shares(context, torque, found.floor).sum() < material) return false;
  return found.null.family_p(fit.hypothesis, grid) <= context.options.false_naming_rate;
}

EffectSearch::State beside_others(const SearchContext& context, const SearchResult& found, std::size_t k) {
  std::vector<AcceptedEffect> others = found.accepted;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
  return context.search.state(found.noise, others, found.pilots.get());
}

Fit fit_beside(const SearchContext& context, const SearchResult& found, const EffectSearch::State& others, std::size_t k) {
  const Fit fit = context.search.refine(others, found.accepted[k].hypothesis);
  return found.hygiene[k] && !hygienic(context, fit) ? found.fits[k] : fit;  // no more than was allowed for without a name
}

/// The hypothesis that fits better than `fit` in its place, now that the others are known; `fit` if there is none.
Fit best_in_place(const SearchContext& context, const SearchResult& found, const EffectSearch::State& others, std::size_t k,
                  Fit fit) {
  if (found.hygiene[k]) return fit;
  const FormErrors form_errors(context, found, others, k);
  const double material = found.accepted.size() > 1 ? kMaterialFurther : kMaterial;
  const auto may_follow = [&](const Fit& one) {
    return !hygienic(context, one) && counts(context, found, others, one, material) && !form_errors.explain(one);
  };
  const std::optional<Fit> best = best_fit(context.search, others, may_follow);
  const bool better = best && context.search.worth(best->hypothesis, best->gain, others) >
                                  context.search.worth(fit.hypothesis, fit.gain, others) + kBetter;
  return better ? *best : fit;
}

/// Takes out the weakest of the effects that no longer count beside the others, or that the others' forms can have left: the first of
/// several may have been a mixture of them. False if there is none.
bool drop_weakest(const SearchContext& context, SearchResult& found) {
  std::optional<std::size_t> weakest;
  double least = 0;
  for (std::size_t k = 0; k < found.accepted.size() && found.accepted.size() > 1; ++k) {
    const EffectSearch::State others = beside_others(context, found, k);
    const Fit fit = fit_beside(context, found, others, k);
    if (weakest && fit.gain >= least) continue;
    const FormErrors form_errors(context, found, others, k);
    if (counts(context, found, others, fit) && (found.hygiene[k] || !form_errors.explain(fit))) continue;
    weakest = k;
    least = fit.gain;
  }
  if (!weakest) return false;
  const auto at = static_cast<std::ptrdiff_t>(*weakest);
  found.accepted.erase(found.accepted.begin() + at);
  found.fits.erase(found.fits.begin() + at);
  found.hygiene.erase(found.hygiene.begin() + at);
  return true;
}

}  // namespace

double rows_per_drive(const SearchContext& context, const WhiteProblem& problem) {
  return static_cast<double>(problem.freedom) / static_cast<double>(context.logs.front().usable.size());
}

SearchResult search_effects(const SearchContext& context, Diagnosis& out, const SearchResult* earlier) {
  const EffectSearch& search = context.search;
  const DiagnosisOptions& options = context.options;
  SearchResult found;
  const auto report = [&](double share) {
    if (options.progress) options.progress(share);
  };

  // Encoder noise: which scores it fakes. With the noise model of the base model; a large effect in it only makes this coarser.
  NoiseEstimate estimate;
  if (earlier != nullptr) {
    estimate.noise = earlier->noise;
    estimate.floor_rms = earlier->floor;
  } else {
    estimate = search.noise_beside({});
  }
  if (earlier != nullptr) {
    found.pilots = earlier->pilots;
  } else {
    const EffectSearch::State state = search.state(estimate.noise, {}, nullptr);
    const double pass_hz =
        std::min(context.processing.torque_cutoff_ratio * context.processing.cutoff_hz, 0.4 * context.logs.front().log.rate_hz);
    found.pilots = std::make_shared<EncoderPilots>(context.model, context.base, context.logs, context.p, *state.problem,
                                                   search.hypotheses(), state.signatures, context.position_noise,
                                                   context.processing.cutoff_hz, pass_hz, options.seed, options.threads);
  }
  const EncoderPilots& pilots = *found.pilots;
  report(0.3);

  // Provisional effects, so that the noise model is not made of what is missing.
  std::vector<AcceptedEffect> provisional;
  for (int step = 0; earlier == nullptr && step < options.max_effects + kHygienic; ++step) {
    std::optional<Fit> fit = most_likely(context, pilots, provisional, estimate);
    if (!fit) break;
    provisional.push_back(search.accept(*fit));
    estimate = search.noise_beside(provisional);
    report(0.3 + 0.03 * (step + 1));
  }
  found.noise = estimate.noise;
  found.floor = estimate.floor_rms;

  // The null, beside the base model, with that noise.
  found.before = search.state(found.noise, {}, &pilots);
  found.omnibus_before = Omnibus(*found.before.problem, context.basis);
  found.structure_before = found.omnibus_before.gains(*found.before.problem, found.before.problem->r);
  if (earlier != nullptr) {
    found.null = earlier->null;
  } else {
    NullOptions null_options;
    null_options.runs = options.null_runs;
    null_options.seed = options.seed;
    null_options.threads = options.threads;
    null_options.progress = [&](double share) { report(0.45 + 0.4 * share); };
    found.null = run_null_study(pilots, *found.before.problem, search.hypotheses(), found.before.signatures, found.before.bias,
                                found.omnibus_before, null_options);
  }
  out.encoder_share = found.null.encoder_share;

  // Forward.
  EffectSearch::State state = search.state(found.noise, {}, &pilots);
  int named = 0;
  while (named < options.max_effects && static_cast<int>(found.accepted.size()) < options.max_effects + 5) {
    const FormErrors form_errors(context, found, state);
    std::optional<Fit> fit = best_fit(search, state, [&](const Fit& one) {
      return counts(context, found, state, one, named > 0 ? kMaterialFurther : kMaterial) && !form_errors.explain(one);
    });
    if (!fit) break;
    found.hygiene.push_back(hygienic(context, *fit));
    named += found.hygiene.back() ? 0 : 1;
    found.accepted.push_back(search.accept(*fit));
    found.fits.push_back(std::move(*fit));
    // An earlier one may have stood for a mixture with the newest: what such a mixture leaves must not be taken for a third.
    for (std::size_t k = 0; k + 1 < found.accepted.size(); ++k) {
      const EffectSearch::State others = beside_others(context, found, k);
      const Fit now = fit_beside(context, found, others, k);
      Fit best = best_in_place(context, found, others, k, now);
      if (best.hypothesis == now.hypothesis) continue;
      found.accepted[k] = search.accept(best);
      found.fits[k] = std::move(best);
    }
    state = search.state(found.noise, found.accepted, &pilots);
  }
  // The first of two may have been a mixture: the best pair, if it is worth more than the best single and its follower.
  if (found.accepted.size() == 2 && named == 2) {
    const EffectSearch::Pair pair = search.best_pair(found.before, kBestForPairs);
    const double forward_gain =
        found.before.problem->r.squaredNorm() -
        search.state(found.noise, {found.accepted[0], found.accepted[1]}, nullptr).problem->r.squaredNorm();
    const auto taken = [&](std::size_t h) { return found.accepted[0].hypothesis == h || found.accepted[1].hypothesis == h; };
    if (pair.gain > 1.02 * forward_gain && !(taken(pair.first) && taken(pair.second))) {
      std::vector<AcceptedEffect> accepted;
      std::vector<Fit> fits;
      for (const std::size_t h : {pair.first, pair.second}) {
        const EffectSearch::State beside = search.state(found.noise, accepted, &pilots);
        fits.push_back(search.refine(beside, h));
        accepted.push_back(search.accept(fits.back()));
      }
      found.accepted = std::move(accepted);
      found.fits = std::move(fits);
    }
  }
  // Backward: each must still count beside the others; then its shape, size and set beside them.
  while (drop_weakest(context, found)) {
  }
  for (std::size_t k = 0; k < found.accepted.size(); ++k) {
    const EffectSearch::State beside = beside_others(context, found, k);
    Fit fit = best_in_place(context, found, beside, k, fit_beside(context, found, beside, k));
    set_uncertainty(context, beside, fit);
    found.sets.push_back(found.hygiene[k] ? std::vector<EffectCandidate>() : confusable_set(context, found, beside, fit, k));
    found.accepted[k] = search.accept(fit);
    found.fits[k] = std::move(fit);
  }
  found.after = search.state(found.noise, found.accepted, &pilots);
  found.omnibus_after = Omnibus(*found.after.problem, context.basis);
  found.structure_after = found.omnibus_after.gains(*found.after.problem, found.after.problem->r);
  return found;
}

}  // namespace deltadyn::detail
