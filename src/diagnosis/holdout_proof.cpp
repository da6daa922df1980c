#include "holdout_proof.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/random.hpp"
#include "deltadyn/runtime/statistics.hpp"

namespace deltadyn::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kProofBlock_s = 0.25;
constexpr int kProofResamples = 1000;
constexpr double kShows = 0.005;    // of the noise variance: less of an effect cannot be seen in the hold-out log
constexpr double kAsksAgain = 0.4;  // of an effect's amplitude that the hold-out log must ask for

}  // namespace

HoldoutProof prove(const SearchContext& context, const SearchResult& found, const LogRows& held,
                   const std::vector<Effect>& known) {
  const Index n = context.robot.drives(), b = context.base.count();
  std::vector<Effect> effects = known;
  MatrixXd corrected = held.tau;  // without the effects whose shape is their amplitude
  for (const AcceptedEffect& one : found.accepted) {
    if (!effect_kind(one.effect.id).tied) {
      effects.push_back(one.effect);
      continue;
    }
    const Hypothesis tied{one.effect.id, one.effect.joint, {one.effect.shape}, 1};
    const std::vector<MatrixXd> rows = hypothesis_rows(context.model, held, held.signals, tied);
    for (std::size_t j = 0; j < rows.size(); ++j) {
      if (rows[j].size() > 0) corrected.col(static_cast<Index>(j)) -= rows[j] * one.effect.amplitude;
    }
  }
  PerLogAndDrive<MatrixXd> extra(1);
  for (Index j = 0; j < n; ++j) extra[0].push_back(MatrixXd::Zero(held.rows(), amplitude_count(effects)));
  Index at = 0;
  for (const Effect& effect : effects) {
    Hypothesis one{
        effect.id, effect.joint, {effect.shape}, static_cast<Index>(effect_kind(effect.id).amplitudes.size())};
    const std::vector<MatrixXd> rows = hypothesis_rows(context.model, held, held.signals, one);
    for (std::size_t j = 0; j < rows.size(); ++j) {
      if (rows[j].size() > 0) extra[0][j].middleCols(at, one.amplitudes) = rows[j];
    }
    at += one.amplitudes;
  }
  HoldoutProof out;
  out.before.resize(held.rows(), n);
  out.after.resize(held.rows(), n);
  out.usable = held.usable;
  out.rms_before.resize(n);
  out.rms_after.resize(n);
  out.floor.resize(n);
  out.unsure.resize(n);
  const WhiteProblem& training = *found.before.problem;
  const MatrixXd covariance = dense::pseudo_inverse(training.X.transpose() * training.X).topLeftCorner(b, b);
  const VectorXd &beta0 = found.before.problem->beta, &beta1 = found.after.problem->beta;
  std::vector<LogRows> alone = {held};
  alone.front().tau = corrected;
  const PerLogAndDrive<double> floor = estimate_noise(alone, make_generic_basis(alone), extra).floor_rms;
  for (Index j = 0; j < n; ++j) {
    const auto drive = static_cast<std::size_t>(j);
    out.before.col(j) = held.tau.col(j) - held.Y[drive] * beta0.head(b) -
                        extra[0][drive].leftCols(beta0.size() - b) * beta0.tail(beta0.size() - b);
    out.after.col(j) =
        corrected.col(j) - held.Y[drive] * beta1.head(b) - extra[0][drive] * beta1.tail(beta1.size() - b);
    const MatrixXd Y_cov = held.Y[drive] * covariance;
    out.unsure(j) = root_mean_square(Y_cov.cwiseProduct(held.Y[drive]).rowwise().sum().cwiseMax(0.0).cwiseSqrt(),
                                     held.usable[drive]);
    out.rms_before(j) = root_mean_square(out.before.col(j), held.usable[drive]);
    out.rms_after(j) = root_mean_square(out.after.col(j), held.usable[drive]);
    // The same log fitted by everything: a model from other logs cannot be expected to do better.
    out.floor(j) = std::min({floor[0][drive], out.rms_before(j), out.rms_after(j)});
  }
  out.effects = std::move(extra[0]);
  return out;
}

void shrink_of(const HoldoutProof& proof, const LogRows& held, const std::vector<int>& drives, std::uint64_t seed,
               Diagnosis& out) {
  std::vector<std::pair<double, double>> blocks;  // squares before and after
  double rows = 0;
  const double row_s = held.t_s(1) - held.t_s(0);
  const auto per_block = std::max<Index>(1, static_cast<Index>(kProofBlock_s / row_s));
  std::vector<double> counts;
  for (Index first = 0; first < held.rows(); first += per_block) {
    double before = 0, after = 0, count = 0;
    for (Index k = first; k < std::min(first + per_block, held.rows()); ++k) {
      for (const int j : drives) {
        if (!proof.usable[static_cast<std::size_t>(j)](k)) continue;
        const double floor = std::max(proof.floor(j), 1e-300);
        before += proof.before(k, j) * proof.before(k, j) / (floor * floor);
        after += proof.after(k, j) * proof.after(k, j) / (floor * floor);
        ++count;
      }
    }
    if (count == 0) continue;
    blocks.emplace_back(before, after);
    counts.push_back(count);
    rows += count;
  }
  const auto shrink = [](double before, double after, double count) {
    const double b = std::sqrt(before / count), a = std::sqrt(after / count);
    return b > 1 + 1e-9 ? (b - a) / (b - 1) : 0.0;
  };
  double before = 0, after = 0;
  for (const auto& block : blocks) {
    before += block.first;
    after += block.second;
  }
  out.gap_shrink = shrink(before, after, rows);
  std::mt19937_64 random(seed);
  const UniformIndex pick(blocks.size());
  std::vector<double> samples;
  int losses = 0;
  for (int k = 0; k < kProofResamples; ++k) {
    double b = 0, a = 0, count = 0;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const std::size_t at = pick(random);
      b += blocks[at].first;
      a += blocks[at].second;
      count += counts[at];
    }
    samples.push_back(shrink(b, a, count));
    losses += a >= b ? 1 : 0;
  }
  std::sort(samples.begin(), samples.end());
  out.gap_low = samples[static_cast<std::size_t>(0.025 * kProofResamples)];
  out.gap_high = samples[static_cast<std::size_t>(0.975 * kProofResamples)];
  out.p_no_gain = (losses + 1.0) / (kProofResamples + 1.0);
}

bool carries_over(const SearchContext& context, const SearchResult& found, const HoldoutProof& proof, const Fit& fit) {
  const LogRows& held = *context.holdout;
  const Hypothesis one{fit.effect.id, fit.effect.joint, {fit.effect.shape}, fit.effect.amplitude.size()};
  const std::vector<MatrixXd> rows = hypothesis_rows(context.model, held, held.signals, one);
  const VectorXd beta = remainder_of(context, *found.before.problem, fit.rows, fit.effect.amplitude).beta;
  const Index b = context.base.count();
  double inner = 0, square = 0, count = 0;
  for (std::size_t j = 0; j < rows.size(); ++j) {
    if (rows[j].size() == 0) continue;
    const VectorXd torque = rows[j] * fit.effect.amplitude - held.Y[j] * beta.head(b) -
                            proof.effects[j].leftCols(beta.size() - b) * beta.tail(beta.size() - b);
    const VectorXd without = proof.after.col(static_cast<Index>(j)) + torque;
    const double weight = 1 / std::max(proof.floor(static_cast<Index>(j)) * proof.floor(static_cast<Index>(j)), 1e-300);
    inner += weight * held.usable[j].select(torque.array() * without.array(), 0.0).sum();
    square += weight * held.usable[j].select(torque.array(), 0.0).square().sum();
    count += static_cast<double>(held.usable[j].count());
  }
  return square < kShows * count || inner > kAsksAgain * square;
}

}  // namespace deltadyn::detail
