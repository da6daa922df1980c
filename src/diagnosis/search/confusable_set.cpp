#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "deltadyn/runtime/dense.hpp"

#include "ranking.hpp"
#include "remainder.hpp"

namespace deltadyn::detail {

namespace {

/// Spread of a sum over the blocks of a quarter of a second that it is made of: how robust is a gain?
double block_std(const SearchContext& context, const WhiteProblem& problem, const VectorXd& difference) {
  std::vector<double> blocks;
  for (const WhiteSegment& segment : problem.segments) {
    for (const auto& [first, count] : row_blocks(context, segment))
      blocks.push_back(difference.segment(first, count).sum());
  }
  const double mean = std::accumulate(blocks.begin(), blocks.end(), 0.0) / static_cast<double>(blocks.size());
  double square = 0;
  for (const double b : blocks) square += (b - mean) * (b - mean);
  return std::sqrt(square);
}

/// Drives that bear a tenth or more of one of the other effects: there, what its form leaves may decide between two
/// names.
std::vector<bool> reached_by_others(const SearchContext& context, const SearchResult& found, std::size_t but) {
  std::vector<bool> out(static_cast<std::size_t>(context.robot.drives()), false);
  for (std::size_t k = 0; k < found.fits.size(); ++k) {
    if (k == but || found.fits[k].hygiene) continue;
    const VectorXd theirs = remaining_squares_by_drive(context, *found.before.problem, found.fits[k]);
    for (Index j = 0; j < theirs.size(); ++j) {
      if (theirs(j) > 0.1 * theirs.sum()) out[static_cast<std::size_t>(j)] = true;
    }
  }
  return out;
}

/// Lead of one name over another as a share of its gain, by the drives that no other effect reaches; infinite if all
/// drives are alike in that, or these gain too little.
/// \param other_worse,none_worse  squares by which the other name, and no name, is worse in each row
/// \param least_gain              of these drives
double clear_lead(const WhiteProblem& problem, const std::vector<bool>& reached, const VectorXd& other_worse,
                  const VectorXd& none_worse, double least_gain) {
  const double nothing = std::numeric_limits<double>::infinity();
  if (std::count(reached.begin(), reached.end(), true) == 0) return nothing;
  double lead = 0, gain = 0;
  for (const WhiteSegment& segment : problem.segments) {
    if (reached[segment.drive]) continue;
    lead += other_worse.segment(segment.offset, segment.rows()).sum();
    gain += none_worse.segment(segment.offset, segment.rows()).sum();
  }
  return gain > least_gain ? lead / gain : nothing;
}

}  // namespace

EffectCandidate candidate_of(const SearchContext& context, const SearchResult& found, const Fit& fit) {
  const Hypothesis& hypothesis = context.search.hypotheses()[fit.hypothesis];
  return {.effect = fit.effect,
          .name = hypothesis.name(),
          .effect_class = std::string(effect_class_name(hypothesis.kind().effect_class)),
          .joint = hypothesis.joint_name(),
          .gain = fit.gain,
          .p_value = found.null.hypotheses.p_value(fit.hypothesis, fit.grid_gain)};
}

std::vector<EffectCandidate> confusable_set(const SearchContext& context, const SearchResult& found,
                                            const EffectSearch::State& state, const Fit& best, std::size_t place) {
  const DiagnosisPolicy& policy = context.policy();
  std::vector<EffectCandidate> set;
  const std::vector<bool> reached = reached_by_others(context, found, place);
  const WhiteProblem& problem = *state.problem;
  const Index k = best.effect.amplitude.size();
  if (best.white.cols() < k) return set;
  const MatrixXd C_best = problem.projected(best.white);
  const VectorXd s_best = C_best * best.effect.amplitude;
  const VectorXd r_best = problem.r - s_best;
  const double best_worth = context.search.worth(best.hypothesis, best.gain, state);
  std::vector<std::size_t> order;
  for (const std::size_t h : best_of(context.search, state, kRefined + 1)) {
    if (h == best.hypothesis || order.size() == kRefined) continue;
    if (state.scores[h].gain < 0.5 * best.gain) break;
    order.push_back(h);
  }
  context.search.refine_all(state, order);
  for (const std::size_t h : order) {
    const Fit& other = context.search.refine(state, h);
    const Index m = other.effect.amplitude.size();
    if (other.white.cols() < m || hygienic(context, other)) continue;
    const VectorXd s_other = problem.projected(other.white) * other.effect.amplitude;
    // Were `other` the truth, how likely would `best` win by so much? Its own direction is what the shapes' freedom
    // leaves.
    const VectorXd coefficients = dense::least_norm(C_best.transpose() * C_best, C_best.transpose() * s_other);
    const double distance = (s_other - C_best * coefficients).norm();
    const double lead = best_worth - context.search.worth(h, other.gain, state);
    const double z = (lead + distance * distance) / std::max(2 * distance, 1e-9);
    const VectorXd r_other = problem.r - s_other;
    const double spread = block_std(context, problem, r_other.cwiseAbs2() - r_best.cwiseAbs2());
    const double raw_lead = r_other.squaredNorm() - r_best.squaredNorm();
    const bool alike = z < policy.set_likelihood;
    const bool by_blocks = raw_lead < policy.set_bootstrap * spread && z < 2 * policy.set_likelihood;
    // An effect with more parameters would have followed a form that the catalogue lacks better, not worse.
    const Hypothesis& one = context.search.hypotheses()[best.hypothesis];
    const Hypothesis& alternative = context.search.hypotheses()[h];
    const double clear = clear_lead(problem, reached, r_other.cwiseAbs2() - r_best.cwiseAbs2(),
                                    problem.r.cwiseAbs2() - r_best.cwiseAbs2(), policy.clear_share * best.gain);
    const bool by_form =
        clear < 0 || (std::min(lead / best.gain, clear) < policy.set_form && alternative.freedom() <= one.freedom());
    const bool by_parsimony =
        alternative.freedom() + kFewer <= one.freedom() && other.gain > policy.as_good * best.gain;
    if (!alike && !by_blocks && !by_form && !by_parsimony) continue;
    // Beside its own special case an effect is no alternative: the case would have to be met by chance.
    if (alternative.joint == one.joint && holds(alternative.id, one.id)) continue;
    Fit sized = other;
    set_uncertainty(context, state, sized);
    EffectCandidate candidate = candidate_of(context, found, sized);
    candidate.gain_share = other.gain / std::max(best.gain, 1e-300);
    candidate.alike = std::abs(s_best.dot(s_other)) / std::max(s_best.norm() * s_other.norm(), 1e-300);
    set.push_back(std::move(candidate));
  }
  return set;
}

}  // namespace deltadyn::detail
