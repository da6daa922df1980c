#include "holdout_proof.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/random.hpp"
#include "deltadyn/runtime/statistics.hpp"

#include "../search/remainder.hpp"

namespace deltadyn::detail {

namespace {

constexpr double kProofBlock_s = 0.25;
constexpr int kProofResamples = 1000;
constexpr double kShows = 0.005;  // of the noise variance: less of an effect cannot be seen in the hold-out log

/// The hold-out log without the torque of effects whose shape is their amplitude, and columns of the others.
struct HeldModel {
  LogRows rows;
  std::vector<MatrixXd> columns;  ///< one a drive

  /// \param loaded  the log has what only some logs have
  HeldModel(const SearchContext& context, const LogRows& held, const std::vector<Effect>& effects, bool loaded) {
    std::vector<LogRows> alone = {held};
    PerLogAndDrive<MatrixXd> extra = no_columns(alone);
    for (const Effect& effect : effects) {
      const bool here = loaded && of_one_log(effect.id);
      alone.front().number = here ? static_cast<int>(std::lround(effect.shape(0))) : held.number;
      const PerLogAndDrive<MatrixXd> of_effect = hypothesis_rows(context.model, alone, hypothesis_of(effect));
      if (effect_kind(effect.id).tied) {
        take_off(of_effect, effect.amplitude, alone);
      } else {
        append_columns(extra, of_effect, effect.amplitude.size());
      }
    }
    rows = std::move(alone.front());
    columns = std::move(extra.front());
  }

  [[nodiscard]] double squares(const VectorXd& beta) const {
    double sum = 0;
    for (std::size_t j = 0; j < columns.size(); ++j) {
      const VectorXd e = residual(static_cast<Index>(j), beta);
      const double scale = std::max(root_mean_square(rows.tau.col(static_cast<Index>(j)), rows.usable[j]), 1e-300);
      sum += rows.usable[j].select(e.array() / scale, 0.0).square().sum();
    }
    return sum;
  }
  [[nodiscard]] VectorXd residual(Index drive, const VectorXd& beta) const {
    const auto j = static_cast<std::size_t>(drive);
    return without_model(rows.tau.col(drive), rows.Y[j], columns[j], beta);
  }
};

}  // namespace

HoldoutProof prove(const SearchContext& context, const SearchResult& found, const LogRows& held,
                   const std::vector<Effect>& known) {
  const Index n = context.robot.drives(), b = context.base.count();
  // What the hold-out log has denied is allowed for in both models: it is no part of what is to be proved.
  std::vector<Effect> effects = known, allowed = known;
  std::vector<Fit> denied;
  for (const Fit& fit : found.fits) {
    effects.push_back(fit.effect);
    if (!context.is_denied(fit.effect)) continue;
    allowed.push_back(fit.effect);
    denied.push_back(fit);
  }
  const VectorXd &beta1 = found.after.problem->beta,
                 beta0 = denied.empty()
                             ? found.before.problem->beta
                             : WhiteProblem(context.search.corrected(denied), found.noise, context.search.extra(denied))
                                   .beta;
  HoldoutProof out;
  HeldModel with(context, held, effects, false);
  if (std::ranges::any_of(effects, [](const Effect& one) { return of_one_log(one.id); })) {
    HeldModel loaded(context, held, effects, true);
    out.has_load = loaded.squares(beta1) < with.squares(beta1);
    if (out.has_load) with = std::move(loaded);
  }
  const HeldModel without(context, held, allowed, false);
  for (MatrixXd* residual : {&out.before, &out.after}) residual->resize(held.rows(), n);
  for (VectorXd* figure : {&out.rms_before, &out.rms_after, &out.floor, &out.unsure}) figure->resize(n);
  const WhiteProblem& training = *found.before.problem;
  const MatrixXd covariance = dense::pseudo_inverse(training.X.transpose() * training.X).topLeftCorner(b, b);
  const std::vector<LogRows> alone = {with.rows};
  const PerLogAndDrive<double> floor = estimate_noise(alone, make_generic_basis(alone), {with.columns}).floor_rms;
  for (Index j = 0; j < n; ++j) {
    const auto drive = static_cast<std::size_t>(j);
    out.before.col(j) = without.residual(j, beta0);
    out.after.col(j) = with.residual(j, beta1);
    const MatrixXd Y_cov = held.Y[drive] * covariance;
    out.unsure(j) = root_mean_square(Y_cov.cwiseProduct(held.Y[drive]).rowwise().sum().cwiseMax(0.0).cwiseSqrt(),
                                     held.usable[drive]);
    out.rms_before(j) = root_mean_square(out.before.col(j), held.usable[drive]);
    out.rms_after(j) = root_mean_square(out.after.col(j), held.usable[drive]);
    // The same log fitted by everything: a model from other logs cannot be expected to do better.
    out.floor(j) = std::min({floor[0][drive], out.rms_before(j), out.rms_after(j)});
  }
  out.effects = with.columns;
  return out;
}

void shrink_of(const HoldoutProof& proof, const LogRows& held, const std::vector<int>& drives, std::uint64_t seed,
               Diagnosis& out) {
  std::vector<Eigen::Array3d> blocks;  // squares before and after, and of how many rows
  const double row_s = held.t_s(1) - held.t_s(0);
  const auto per_block = std::max<Index>(1, static_cast<Index>(kProofBlock_s / row_s));
  Eigen::Array3d all = Eigen::Array3d::Zero();
  for (Index first = 0; first < held.rows(); first += per_block) {
    Eigen::Array3d block = Eigen::Array3d::Zero();
    for (Index k = first; k < std::min(first + per_block, held.rows()); ++k) {
      for (const int j : drives) {
        if (!held.usable[static_cast<std::size_t>(j)](k)) continue;
        const double floor = std::max(proof.floor(j), 1e-300), square = floor * floor;
        block += Eigen::Array3d(proof.before(k, j) * proof.before(k, j) / square,
                                proof.after(k, j) * proof.after(k, j) / square, 1);
      }
    }
    if (block(2) == 0) continue;
    blocks.push_back(block);
    all += block;
  }
  const auto shrink = [](const Eigen::Array3d& sum) {
    const double b = std::sqrt(sum(0) / sum(2)), a = std::sqrt(sum(1) / sum(2));
    return b > 1 + 1e-9 ? (b - a) / (b - 1) : 0.0;
  };
  out.gap_shrink = shrink(all);
  std::mt19937_64 random(seed);
  const UniformIndex pick(blocks.size());
  std::vector<double> samples;
  for (int k = 0; k < kProofResamples; ++k) {
    Eigen::Array3d sum = Eigen::Array3d::Zero();
    for (std::size_t i = 0; i < blocks.size(); ++i) sum += blocks[pick(random)];
    samples.push_back(shrink(sum));
  }
  std::sort(samples.begin(), samples.end());
  out.gap_low = samples[static_cast<std::size_t>(0.025 * kProofResamples)];
  out.gap_high = samples[static_cast<std::size_t>(0.975 * kProofResamples)];
}

bool carries_over(const SearchContext& context, const SearchResult& found, const HoldoutProof& proof, const Fit& fit) {
  LogRows held = *context.holdout;
  if (proof.has_load && of_one_log(fit.effect.id)) held.number = static_cast<int>(std::lround(fit.effect.shape(0)));
  const std::vector<MatrixXd> rows = hypothesis_rows(context.model, held, held.signals, hypothesis_of(fit.effect));
  const VectorXd beta = remainder_of(context, *found.before.problem, fit.rows, fit.effect.amplitude).beta;
  double inner = 0, square = 0, count = 0;
  for (std::size_t j = 0; j < rows.size(); ++j) {
    if (rows[j].size() == 0) continue;
    const VectorXd torque = without_model(rows[j] * fit.effect.amplitude, held.Y[j], proof.effects[j], beta);
    const VectorXd without = proof.after.col(static_cast<Index>(j)) + torque;
    const double weight = 1 / std::max(proof.floor(static_cast<Index>(j)) * proof.floor(static_cast<Index>(j)), 1e-300);
    inner += weight * held.usable[j].select(torque.array() * without.array(), 0.0).sum();
    square += weight * held.usable[j].select(torque.array(), 0.0).square().sum();
    count += static_cast<double>(held.usable[j].count());
  }
  return square < kShows * count || inner > context.policy().hardly_explained * square;
}

}  // namespace deltadyn::detail
