#include "effect_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "deltadyn/identification/non_negative_least_squares.hpp"
#include "deltadyn/runtime/golden_section.hpp"
#include "deltadyn/runtime/in_parallel.hpp"

namespace deltadyn {

namespace {

PerLogAndDrive<MatrixXd> columns_of(const PerLogAndDrive<MatrixXd>& rows, Index first, Index count) {
  PerLogAndDrive<MatrixXd> out = rows;
  for (auto& log : out) {
    for (MatrixXd& drive : log) {
      if (drive.size() > 0) drive = MatrixXd(drive.middleCols(first, count));
    }
  }
  return out;
}

/// How a shape parameter may move between the start values: factor down and up, or step.
struct Reach {
  bool free = false, logarithmic = true;
  double low = 0, high = 0;
};

Reach reach_of(const Hypothesis& hypothesis, std::size_t parameter, const VectorXd& shape) {
  const ShapeTraits& kind = hypothesis.kind().shapes[parameter];
  const ShapeSearch& search = kind.search;
  const double value = shape(static_cast<Index>(parameter));
  if (!shape_is_free(hypothesis.id, parameter, shape)) return {};
  double next = std::numeric_limits<double>::infinity(),
         least = value;  // distance of the next start value, and the least
  for (const VectorXd& other : hypothesis.shapes) {
    const double start = other(static_cast<Index>(parameter)), distance = std::abs(start - value);
    least = std::min(least, start);
    if (distance > 1e-12) next = std::min(next, distance);
  }
  if (kind.scale == ShapeScale::waves) {
    const double spacing = std::min(0.25 * std::abs(value), next);
    // The longest start value is one wave over the range.
    return {true, false, search.least >= 1 ? std::max(value - spacing, least) : value - spacing, value + spacing};
  }
  if (kind.scale == ShapeScale::place) {  // to the next start value, or as far again beyond the last
    const double spacing = std::isfinite(next) ? next : 0.0;
    return {true, false, value - spacing, value + spacing};
  }
  if (search.kind == ShapeSearch::by_difference)
    return {true, false, std::max(search.least, value + search.low), value + search.high};
  return {true, true, search.low * value, search.high * value};
}

/// What encoder noise fakes of hypothesis `h` at the shape of a score; empty: not known.
VectorXd bias_of(const EffectSearch::State& state, std::size_t h, const Score& score) {
  const Index k = score.amplitude.size();
  return state.bias[h].size() > 0 ? VectorXd(state.bias[h].segment(static_cast<Index>(score.shape) * k, k))
                                  : VectorXd();
}

}  // namespace

PerLogAndDrive<MatrixXd> no_columns(const std::vector<LogRows>& logs) {
  PerLogAndDrive<MatrixXd> out;
  for (const LogRows& log : logs) out.emplace_back(log.usable.size(), MatrixXd(log.rows(), 0));
  return out;
}

void append_columns(PerLogAndDrive<MatrixXd>& to, const PerLogAndDrive<MatrixXd>& from, Index columns) {
  for (std::size_t l = 0; l < to.size(); ++l) {
    for (std::size_t j = 0; j < to[l].size(); ++j) {
      MatrixXd& target = to[l][j];
      target.conservativeResize(Eigen::NoChange, target.cols() + columns);
      target.rightCols(columns).setZero();
      if (from[l][j].size() > 0) target.rightCols(columns) = from[l][j];
    }
  }
}

void take_off(const PerLogAndDrive<MatrixXd>& rows, const VectorXd& amplitude, std::vector<LogRows>& logs) {
  for (std::size_t l = 0; l < logs.size(); ++l) {
    for (std::size_t j = 0; j < rows[l].size(); ++j) {
      if (rows[l][j].size() > 0) logs[l].tau.col(static_cast<Index>(j)) -= rows[l][j] * amplitude;
    }
  }
}

EffectSearch::EffectSearch(const EffectModel& model, const std::vector<LogRows>& logs, const GenericBasis& basis,
                           const std::vector<Effect>& known, const VectorXd& presliding)
    : model_(model),
      logs_(logs),
      basis_(basis),
      hypotheses_(all_hypotheses(model.robot(), logs, known)),
      known_rows_(no_columns(logs)) {
  std::erase_if(hypotheses_, [&](const Hypothesis& one) {
    return one.kind().role == Role::bristle && one.joint < presliding.size() && presliding(one.joint) > 0;
  });
  rows_.resize(hypotheses_.size());
  in_parallel(hypotheses_.size(), [&](std::size_t h) { rows_[h] = hypothesis_rows(model_, logs_, hypotheses_[h]); });
  for (const Effect& effect : known) {
    const Hypothesis hypothesis = hypothesis_of(effect);
    append_columns(known_rows_, hypothesis_rows(model_, logs_, hypothesis), hypothesis.amplitudes);
  }
}

PerLogAndDrive<MatrixXd> EffectSearch::extra(const std::vector<Fit>& accepted) const {
  PerLogAndDrive<MatrixXd> out = known_rows_;
  for (const Fit& one : accepted) {
    const Hypothesis& hypothesis = hypotheses_[one.hypothesis];
    if (!hypothesis.kind().tied) append_columns(out, one.rows, hypothesis.amplitudes);
  }
  return out;
}

std::vector<LogRows> EffectSearch::corrected(const std::vector<Fit>& accepted) const {
  std::vector<LogRows> out = logs_;
  for (const Fit& one : accepted) {
    if (effect_kind(one.effect.id).tied) take_off(one.rows, one.effect.amplitude, out);
  }
  return out;
}

NoiseEstimate EffectSearch::noise_beside(const std::vector<Fit>& accepted,
                                         const PerLogAndDrive<NoiseModel>* start) const {
  return estimate_noise(corrected(accepted), basis_, extra(accepted), start);
}

EffectSearch::State EffectSearch::state(const PerLogAndDrive<NoiseModel>& noise, const std::vector<Fit>& accepted,
                                        const EncoderPilots* pilots) const {
  State out;
  out.problem = std::make_unique<WhiteProblem>(corrected(accepted), noise, extra(accepted));
  out.signatures.resize(hypotheses_.size());
  out.scores.resize(hypotheses_.size());
  out.bias.resize(hypotheses_.size());
  std::vector<char> held(hypotheses_.size(), 0);
  for (const Fit& one : accepted) held[one.hypothesis] = 1;
  in_parallel(hypotheses_.size(),
              [&](std::size_t h) { out.signatures[h] = make_signature(*out.problem, hypotheses_[h], rows_[h]); });
  if (pilots != nullptr) {
    out.bias = pilots->bias(*out.problem, out.signatures);
    pilots->correct(*out.problem, out.signatures);
  }
  in_parallel(hypotheses_.size(), [&](std::size_t h) {
    out.scores[h].amplitude = VectorXd::Zero(hypotheses_[h].amplitudes);
    const WhiteColumns& white = out.signatures[h].white;
    if (held[h] || white.cols() == 0) return;
    const VectorXd inner = freed_of_bias(out.problem->inner(white), out.bias[h]);
    out.scores[h] = best_score(hypotheses_[h], out.signatures[h], inner);
  });
  return out;
}

double EffectSearch::worth(std::size_t hypothesis, double gain, const State& state) const {
  return gain - hypotheses_[hypothesis].freedom() * std::log(static_cast<double>(state.problem->freedom));
}

std::vector<std::size_t> EffectSearch::ranked(const State& state, std::size_t count) const {
  std::vector<std::size_t> order(hypotheses_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return worth(a, state.scores[a].gain, state) > worth(b, state.scores[b].gain, state);
  });
  order.resize(std::min(count, order.size()));
  return order;
}

const Fit& EffectSearch::refine(const State& state, std::size_t h) const {
  const auto found = state.refined.find(h);
  return found != state.refined.end() ? found->second : state.refined.emplace(h, find_refined(state, h)).first->second;
}

void EffectSearch::refine_all(const State& state, const std::vector<std::size_t>& hypotheses) const {
  std::vector<std::size_t> missing;
  for (const std::size_t h : hypotheses) {
    if (state.refined.count(h) == 0) missing.push_back(h);
  }
  std::vector<Fit> fits(missing.size());
  in_parallel(missing.size(), [&](std::size_t k) { fits[k] = find_refined(state, missing[k]); });
  for (std::size_t k = 0; k < missing.size(); ++k) state.refined.emplace(missing[k], std::move(fits[k]));
}

std::vector<Score> EffectSearch::starts(const State& state, std::size_t h) const {
  const Hypothesis& hypothesis = hypotheses_[h];
  const EffectKind& kind = hypothesis.kind();
  std::vector<Score> out = {state.scores[h]};
  const Signature& signature = state.signatures[h];
  const auto is_fixed = [](const ShapeTraits& shape) { return shape.search.kind == ShapeSearch::fixed; };
  if (std::ranges::all_of(kind.shapes, is_fixed) || signature.white.cols() == 0 || !(out.front().gain > 0)) return out;
  const auto choice = [&](const VectorXd& shape) {
    std::vector<double> values;
    for (std::size_t k = 0; k < kind.shapes.size(); ++k)
      if (is_fixed(kind.shapes[k])) values.push_back(shape(static_cast<Index>(k)));
    return values;
  };
  const VectorXd inner = freed_of_bias(state.problem->inner(signature.white), state.bias[h]);
  std::set<std::vector<double>> seen = {choice(hypothesis.shapes[out.front().shape])};
  for (const VectorXd& shape : hypothesis.shapes) {
    const std::vector<double> other = choice(shape);
    if (!seen.insert(other).second) continue;
    Score score = best_score(hypothesis, signature, inner, [&](const VectorXd& one) { return choice(one) == other; });
    if (score.gain > 0) out.push_back(std::move(score));
  }
  return out;
}

Fit EffectSearch::find_refined(const State& state, std::size_t h) const {
  constexpr double kAlike = 3.84;  // chi-square of one degree of freedom, 95 %
  Fit best;
  for (const Score& start : starts(state, h)) {
    Fit fit = refined_from(state, h, start);
    fit.grid_gain = state.scores[h].gain;
    // Of two that the logs cannot tell apart, the larger one only owes its size to speeds or places that they lack.
    const bool smaller = fit.effect.amplitude.norm() < best.effect.amplitude.norm();
    if (best.rows.empty() || fit.gain > best.gain + (smaller ? -kAlike : kAlike)) best = std::move(fit);
  }
  best.white = state.problem->whiten(best.rows);
  return best;
}

Fit EffectSearch::refined_from(const State& state, std::size_t h, const Score& start) const {
  const Hypothesis& hypothesis = hypotheses_[h];
  const Index k = hypothesis.amplitudes;
  Fit best;
  best.hypothesis = h;
  best.grid_gain = best.gain = start.gain;
  best.effect.id = hypothesis.id;
  best.effect.joint = hypothesis.joint;
  best.effect.shape = hypothesis.shapes[start.shape];
  best.effect.amplitude = start.amplitude;
  best.rows = columns_of(rows_[h], static_cast<Index>(start.shape) * k, k);
  // What encoder noise fakes changes little from one shape to the next.
  const VectorXd bias = bias_of(state, h, start);
  const auto fit_with = [&](const VectorXd& shape) {
    Hypothesis one = hypothesis;
    one.shapes = {shape};
    Fit fit = best;
    fit.rows = hypothesis_rows(model_, logs_, one);
    Signature signature = make_signature(*state.problem, one, fit.rows);
    signature.clean = {state.signatures[h].clean[start.shape]};
    const Score score = best_score(one, signature, freed_of_bias(state.problem->inner(signature.white), bias));
    fit.effect.shape = shape;
    fit.effect.amplitude = score.amplitude;
    fit.gain = score.gain;
    return fit;
  };
  constexpr int kFirstSteps = 9, kLaterSteps = 5;
  const std::size_t parameters = hypothesis.kind().shapes.size();
  for (int sweep = 0; sweep < 2; ++sweep) {
    for (std::size_t parameter = 0; parameter < parameters && start.gain > 0; ++parameter) {
      const Reach reach = reach_of(hypothesis, parameter, best.effect.shape);
      if (!reach.free) continue;
      // Golden section, in the logarithm where the scale is one.
      const double sign = best.effect.shape(static_cast<Index>(parameter)) < 0 ? -1.0 : 1.0;
      const auto to = [&](double x) { return reach.logarithmic ? std::log(sign * x) : x; };
      const auto from = [&](double x) { return reach.logarithmic ? sign * std::exp(x) : x; };
      double low = to(reach.low), high = to(reach.high);
      if (low > high) std::swap(low, high);
      const auto gain_at = [&](double x) {
        VectorXd shape = best.effect.shape;
        shape(static_cast<Index>(parameter)) = from(x);
        Fit trial = fit_with(shape);
        const double gain = trial.gain;
        if (gain > best.gain) best = std::move(trial);
        return gain;
      };
      (void)golden_section([&](double x) { return -gain_at(x); }, low, high, sweep == 0 ? kFirstSteps : kLaterSteps);
    }
  }
  return best;
}

EffectSearch::Pair EffectSearch::best_pair(const State& state, std::size_t best) const {
  const std::vector<std::size_t> order = ranked(state, best);
  struct One {
    WhiteColumns white;
    VectorXd inner;
    std::vector<bool> positive;
  };
  std::vector<One> ones;
  for (const std::size_t h : order) {
    const Index k = hypotheses_[h].amplitudes;
    const Signature& signature = state.signatures[h];
    One one;
    if (signature.white.cols() > 0) {
      one.white = signature.white.part(static_cast<Index>(state.scores[h].shape) * k, k);
      one.inner = freed_of_bias(state.problem->inner(one.white), bias_of(state, h, state.scores[h]));
    }
    for (const AmplitudeTraits& amplitude : hypotheses_[h].kind().amplitudes)
      one.positive.push_back(amplitude.positive());
    ones.push_back(std::move(one));
  }
  Pair out;
  double best_worth = 0;
  for (std::size_t a = 0; a < ones.size(); ++a) {
    for (std::size_t c = a + 1; c < ones.size(); ++c) {
      if (ones[a].inner.size() == 0 || ones[c].inner.size() == 0) continue;
      const Index ka = ones[a].inner.size(), kc = ones[c].inner.size();
      MatrixXd G(ka + kc, ka + kc);
      const MatrixXd cross = cross_gram(ones[a].white, ones[c].white);
      G << ones[a].white.clear_gram(0, ka), cross, cross.transpose(), ones[c].white.clear_gram(0, kc);
      VectorXd u(ka + kc);
      u << ones[a].inner, ones[c].inner;
      std::vector<bool> positive = ones[a].positive;
      positive.insert(positive.end(), ones[c].positive.begin(), ones[c].positive.end());
      const double gain = non_negative_least_squares(G, u, positive).gain;
      const double value = worth(order[a], gain, state) + worth(order[c], 0, state);
      if (value > best_worth) {
        best_worth = value;
        out = {order[a], order[c], gain};
      }
    }
  }
  return out;
}

}  // namespace deltadyn
