#include "explains_more.hpp"

namespace deltadyn::detail {

namespace {

/// Squares of the hold-out residual beside the names, each drive in units of `scale`'s residual without them.
double left_of_holdout(const Diagnosis& diagnosis, const Diagnosis& scale) {
  double sum = 0;
  for (std::size_t j = 0; j < diagnosis.holdout_figures.size(); ++j) {
    const double given = scale.holdout_figures[j].rms_given, written = diagnosis.holdout_figures[j].rms_written;
    if (given > 0) sum += written * written / (given * given);
  }
  return sum;
}

}  // namespace

bool explains_more(const Diagnosis& one, const Diagnosis& other) {
  const bool name = gives_a_name(one.verdict), other_name = gives_a_name(other.verdict);
  if (!name || !other_name) return name && !other_name;
  const bool held = !one.holdout_figures.empty() && one.holdout_figures.size() == other.holdout_figures.size();
  if (held) return left_of_holdout(one, other) < left_of_holdout(other, other);
  return one.explained_share > other.explained_share;
}

}  // namespace deltadyn::detail
