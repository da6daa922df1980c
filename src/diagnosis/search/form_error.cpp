#include "form_error.hpp"

#include <algorithm>

#include "remainder.hpp"

namespace deltadyn::detail {

namespace {

EffectClass class_of(EffectId id) {
  return effect_kind(id).effect_class;
}

/// Does `other` depend on what `one` depends on? Memory of a reversal is a function of the way since then. Losses in a
/// gear that are stated for its one side are, for the other side, such losses and a share of the torque itself, as
/// gravity and inertia make it. And friction that differs by direction may do so by rate, place or time.
bool alike(EffectId one, EffectId other) {
  using Class = EffectClass;
  const Class a = class_of(one), b = class_of(other);
  const auto by_position = [](Class c) { return c == Class::position_periodic || c == Class::reversal_memory; };
  const bool b_of_torque =
      b == Class::load || b == Class::quasi_constant || b == Class::pose_force || b == Class::inertia_like;
  const bool b_of_friction =
      by_position(b) || b == Class::velocity_shape || b == Class::quasi_constant || b == Class::drift;
  return a == b || (by_position(a) && by_position(b)) || (a == Class::load && b_of_torque) ||
         (effect_kind(one).by_direction && b_of_friction);
}

}  // namespace

FormErrors::FormErrors(const SearchContext& context, const SearchResult& found, const EffectSearch::State& state,
                       std::optional<std::size_t> but)
    : context_(context), found_(found), state_(state), but_(but) {
  for (const Fit& fit : found.fits) squares_.push_back(remaining_squares_by_drive(context, *found.before.problem, fit));
}

double FormErrors::gain_of(std::size_t k) const {
  return std::max(found_.fits[k].gain, but_ ? found_.before.scores[found_.fits[k].hypothesis].gain : 0.0);
}

bool FormErrors::stands_out(const Fit& fit) const {
  const auto& hypotheses = context_.search.hypotheses();
  double other = 0;
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    if (class_of(hypotheses[h].id) != class_of(fit.effect.id)) other = std::max(other, state_.scores[h].gain);
  }
  return fit.gain > context_.policy().stands_out * other;
}

double FormErrors::best_at(int joint) const {
  double best = 0;
  for (std::size_t h = 0; h < context_.search.hypotheses().size(); ++h) {
    if (context_.search.hypotheses()[h].joint == joint) best = std::max(best, state_.scores[h].gain);
  }
  return best;
}

bool FormErrors::explain(const Fit& fit) const {
  const DiagnosisPolicy& policy = context_.policy();
  const VectorXd own = remaining_squares_by_drive(context_, *found_.before.problem, fit);
  for (std::size_t k = 0; k < squares_.size(); ++k) {
    if (!counts(k)) continue;
    const Effect& other = found_.fits[k].effect;
    const VectorXd& theirs = squares_[k];
    double shared = 0;
    for (Index j = 0; j < own.size(); ++j) {
      if (own(j) > policy.reached * own.sum()) shared += theirs(j);
    }
    const double left = shared / std::max(theirs.sum(), 1e-300) * gain_of(k);
    const bool same_kind = fit.effect.id == other.id, depends_alike = alike(other.id, fit.effect.id);
    const bool here = (fit.effect.joint == other.joint && (other.joint >= 0 || depends_alike)) ||
                      (other.joint >= 0 && best_at(other.joint) > policy.as_good * fit.gain);
    const FormShare form = effect_kind(other.id).form;
    double share = depends_alike ? form.own : form.other;
    // A second effect of a kind may be the first one at the wrong place.
    if (!here)
      share = same_kind ? policy.form_elsewhere
                        : std::min(share, depends_alike ? policy.form_elsewhere : policy.form_other);
    if (fit.gain < policy.form_anywhere * gain_of(k)) return true;
    if (fit.gain < share * left && (here || depends_alike || !stands_out(fit))) return true;
  }
  return false;
}

}  // namespace deltadyn::detail
