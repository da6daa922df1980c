#include "signature.hpp"

#include <algorithm>
#include <cmath>

#include "deltadyn/identification/non_negative_least_squares.hpp"

namespace deltadyn {

Signature make_signature(const WhiteProblem& problem, const Hypothesis& hypothesis,
                         const PerLogAndDrive<MatrixXd>& rows) {
  Signature out;
  out.white = problem.whiten(rows);
  const Index k = hypothesis.amplitudes;
  for (std::size_t s = 0; s < hypothesis.shapes.size(); ++s) {
    const Index first = static_cast<Index>(s) * k;
    const bool anywhere = out.white.cols() >= first + k;
    const double whole = anywhere ? out.white.raw_gram(first, k).trace() : 0.0;
    out.gram.push_back(anywhere ? out.white.clear_gram(first, k) : MatrixXd::Zero(k, k));
    out.kept.push_back(whole > 0 ? std::max(0.0, out.gram.back().trace() / whole) : 0.0);
  }
  out.clean.assign(hypothesis.shapes.size(), 1);
  return out;
}

Score best_score(const Hypothesis& hypothesis, const Signature& signature, const VectorXd& inner,
                 const std::function<bool(const VectorXd&)>& among) {
  const EffectKind& kind = hypothesis.kind();
  const Index k = hypothesis.amplitudes;
  std::vector<bool> positive;
  for (const AmplitudeTraits& amplitude : kind.amplitudes) positive.push_back(amplitude.positive());
  Score best;
  best.amplitude = VectorXd::Zero(k);
  if (signature.white.cols() == 0) return best;
  for (std::size_t s = 0; s < hypothesis.shapes.size(); ++s) {
    if (signature.kept[s] < kAbsorbed || (among && !among(hypothesis.shapes[s]))) continue;
    const VectorXd u = inner.segment(static_cast<Index>(s) * k, k);
    NonNegativeSolution found;
    if (kind.tied) {
      const double amount = hypothesis.shapes[s](0);
      // Noise in the column would make the amplitude, here fixed, come out too large for the data.
      found.gain = 2 * amount * u(0) - amount * amount * signature.clean[s] * signature.gram[s](0, 0);
      found.x = VectorXd::Constant(1, amount);
    } else {
      found = non_negative_least_squares(signature.gram[s], u, positive);
      bool too_large = false;
      for (Index c = 0; c < k; ++c) too_large |= std::abs(found.x(c)) > hypothesis.largest(static_cast<std::size_t>(c));
      // ... and a fitted one too small.
      if (!too_large) found.x /= signature.clean[s];
      for (Index c = 0; c < k; ++c) {
        const double largest = hypothesis.largest(static_cast<std::size_t>(c));
        found.x(c) = std::clamp(found.x(c), -largest, largest);
      }
      if (too_large) found.gain = 2 * found.x.dot(u) - found.x.dot(signature.gram[s] * found.x);
    }
    if (found.gain > best.gain) best = {found.gain, s, found.x};
  }
  return best;
}

}  // namespace deltadyn
