#include "rules.hpp"

#include <algorithm>

namespace deltadyn::detail {

namespace {

using Facts = VerdictFacts;
using Policy = DiagnosisPolicy;

/// Names that the hold-out log does not speak against.
bool names_stand(const Facts& f, const Policy& p) {
  return f.names > 0 && hold_on_holdout(f, p);
}

bool explain_too_little(const Facts& f, const Policy& p) {
  const double least = f.names > 1 ? p.explained_by_many : p.hardly_explained;
  return f.names > 0 && f.structure_left > p.material_further && f.explained_share < least;
}

bool structure_is_left(const Facts& f, const Policy& p) {
  return f.structure_counts && (f.names == 0 || f.explained_share < p.explained);
}

bool course_is_open(const Facts& f, const Policy& p) {
  return names_stand(f, p) && f.open_courses == f.names;
}

}  // namespace

bool hold_on_holdout(const Facts& f, const Policy& p) {
  // Names that leave about twice as much there as in training fit these by chance, unless they close most of the gap.
  if (f.holdout_left > p.holdout_gap * p.holdout_gap) return f.gap_closed >= p.explained;
  // A gap that is hardly larger than the noise tells neither way: what is written then has to be proved on more rows.
  const bool tells = f.holdout_gap > p.worse && f.gap_closed_at_most < p.closed;
  return f.gap_closed >= (tells ? p.closed : p.closed_of_little);
}

const std::vector<VerdictRule>& verdict_rules() {
  using Reason = VerdictReason;
  using Verdict = DiagnosisVerdict;
  static const std::vector<VerdictRule> rules = {
      {Reason::names_explain_too_little, Verdict::unknown_structure, explain_too_little},
      {Reason::structure_without_name, Verdict::unknown_structure, structure_is_left},
      {Reason::holdout_contradicts_names, Verdict::unknown_structure,
       [](const Facts& f, const Policy& p) { return f.names > 0 && !names_stand(f, p) && f.overt; }},
      // From here on names that do not stand count as none: they were chance, or a trace of no use to anybody.
      {Reason::slow_torque, Verdict::unknown_structure,
       [](const Facts& f, const Policy& p) {
         return f.slow_drive >= 0 && (!names_stand(f, p) || course_is_open(f, p));
       }},
      {Reason::course_open, Verdict::not_testable, course_is_open},
      {Reason::holdout_moves_elsewhere, Verdict::not_testable,
       [](const Facts& f, const Policy& p) { return !names_stand(f, p) && f.missed_drive >= 0; }},
      {Reason::base_parameters_hidden, Verdict::not_testable,
       [](const Facts& f, const Policy& p) { return !names_stand(f, p) && f.base_hidden; }},
      {Reason::nothing_counts, Verdict::nothing_missing,
       [](const Facts& f, const Policy& p) { return !names_stand(f, p); }},
      {Reason::holdout_too_short, Verdict::not_testable,
       [](const Facts& f, const Policy&) { return f.written == WrittenModelIs::not_testable; }},
      {Reason::written_model_refused, Verdict::unknown_structure,
       [](const Facts& f, const Policy&) { return f.written == WrittenModelIs::no_better && f.overt; }},
      {Reason::not_borne_out, Verdict::nothing_missing,
       [](const Facts& f, const Policy&) { return f.written == WrittenModelIs::no_better; }},
      {Reason::several_names_fit, Verdict::confusable, [](const Facts& f, const Policy&) { return f.sets; }},
      {Reason::one_name_fits, Verdict::named, [](const Facts&, const Policy&) { return true; }}};
  return rules;
}

const VerdictRule& deciding_rule(const Facts& facts, const Policy& policy) {
  return *std::ranges::find_if(verdict_rules(), [&](const VerdictRule& rule) { return rule.holds(facts, policy); });
}

}  // namespace deltadyn::detail
