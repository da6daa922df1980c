#include "form_error.hpp"

#include <algorithm>

namespace deltadyn::detail {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr double kHere = 0.12;        // of a plain effect's gain: what the catalogue's form may leave of the true one
constexpr double kAsGoodHere = 0.06;  // the same if another effect at that place would do as well as the one in question
constexpr double kElsewhere = 0.03;   // the same for what that form leaves at another place ...
constexpr double kOther = 0.01;       // ... for effects of another class there ...
constexpr double kAnywhere = 1e-4;    // ... and for any effect, as the parameters carry such errors to all drives
constexpr double kLeftOver = 0.2;     // of the structure: an effect that leaves less is no error of form ...
constexpr double kFarMore = 3.0;      // ... nor one that gains so many times what the best of any other class does
constexpr double kAsGood = 0.9;       // share of a gain from which an effect at the earlier one's place would do as well
constexpr double kReached = 0.05;     // of an effect's squares: a drive with less is not reached

}  // namespace

const std::string& FormErrors::class_of(const Fit& fit) const {
  return context_.search.hypotheses()[fit.hypothesis].kind().effect_class;
}

double FormErrors::structure_of(const VectorXd& r) const {
  const VectorXd gains = omnibus_->gains(*state_.problem, r);
  double sum = 0;
  for (Index j = 0; j < gains.size(); ++j)
    sum += std::max(0.0, gains(j) - found_.null.omnibus[static_cast<std::size_t>(j)].quantile(0.5));
  return sum;
}

bool FormErrors::stands_out(const Fit& fit) {
  const Index k = fit.effect.amplitude.size();
  if (fit.white.cols < k) return false;
  const auto& hypotheses = context_.search.hypotheses();
  double other = 0;
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    if (hypotheses[h].kind().effect_class != class_of(fit)) other = std::max(other, state_.scores[h].gain);
  }
  if (fit.gain > kFarMore * other) return true;
  const WhiteProblem& problem = *state_.problem;
  if (!omnibus_) {
    omnibus_.emplace(problem, context_.basis);
    structure_ = structure_of(problem.r);
  }
  const VectorXd left = problem.r - fit.white.projected(problem.Q, problem.segments, 0, k) * fit.effect.amplitude;
  return structure_of(left) < kLeftOver * structure_;
}

double FormErrors::best_at(int joint) const {
  double best = 0;
  for (std::size_t h = 0; h < context_.search.hypotheses().size(); ++h) {
    if (context_.search.hypotheses()[h].joint == joint) best = std::max(best, state_.scores[h].gain);
  }
  return best;
}

bool FormErrors::explain(const Fit& fit) {
  const VectorXd own = squares_by_drive(context_, *state_.problem, fit);
  // A second effect of a class may be the first one at the wrong place.
  bool class_is_there = false;
  for (std::size_t k = 0; k < found_.fits.size(); ++k) class_is_there |= counts(k) && class_of(found_.fits[k]) == class_of(fit);
  for (std::size_t k = 0; k < found_.fits.size(); ++k) {
    if (!counts(k)) continue;
    const Fit& earlier = found_.fits[k];
    const VectorXd theirs = squares_by_drive(context_, *state_.problem, earlier);
    double shared = 0;
    for (Index j = 0; j < own.size(); ++j) {
      if (own(j) > kReached * own.sum()) shared += theirs(j);
    }
    const double share = shared / std::max(theirs.sum(), 1e-300);
    const bool alike = class_of(fit) == class_of(earlier);
    const bool same_place = fit.effect.joint == earlier.effect.joint && (fit.effect.joint >= 0 || alike);
    const bool as_good = !same_place && earlier.effect.joint >= 0 && best_at(earlier.effect.joint) > kAsGood * fit.gain;
    const bool here = same_place || as_good;
    const double form = same_place ? kHere : as_good ? kAsGoodHere : alike ? kElsewhere : kOther;
    if (fit.gain < kAnywhere * earlier.gain) return true;
    if (fit.gain >= form * share * earlier.gain) continue;
    if (here || class_is_there || !stands_out(fit)) return true;
  }
  return false;
}

}  // namespace deltadyn::detail
