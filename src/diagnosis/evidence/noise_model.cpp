#include "noise_model.hpp"

#include <algorithm>
#include <cmath>

namespace deltadyn {

namespace {

constexpr Index kLeastPairs = 2;  // one in so many rows must have a usable row at the lag of the order

/// A stable model has died out after a few thousand rows.
std::vector<double> impulse_response(const VectorXd& ar) {
  constexpr std::size_t kLongest = 20000;
  std::vector<double> h = {1.0};
  double sum = 1.0, recent = 1.0;  // squares: of all, and of the last order() values
  const auto order = static_cast<std::size_t>(ar.size());
  while (order > 0 && h.size() < kLongest && recent > 1e-10 * sum) {
    double next = 0;
    for (std::size_t k = 0; k < std::min(order, h.size()); ++k) next += ar(static_cast<Index>(k)) * h[h.size() - 1 - k];
    h.push_back(next);
    sum += next * next;
    recent = 0;
    for (std::size_t k = 0; k < std::min(order, h.size()); ++k) recent += h[h.size() - 1 - k] * h[h.size() - 1 - k];
  }
  return h;
}

/// Levinson's step: the autoregression of the next order.
VectorXd extended(const VectorXd& ar, double reflection) {
  VectorXd next(ar.size() + 1);
  next << ar - reflection * ar.reverse(), reflection;
  return next;
}

/// Draws every pole inwards by a factor, and sets the size of what is then left.
void damp(double damping, const Eigen::Ref<const VectorXd>& residual, const RowMask& usable, NoiseModel& noise) {
  double factor = 1;
  for (double& coefficient : noise.ar) coefficient *= factor *= damping;
  double sum = 0, innovations = 0;
  for (Index t = noise.order(); t < residual.size(); ++t) {
    // `run` usable rows stand right before row t.
    Index run = 0;
    while (run < noise.order() && usable(t - 1 - run)) ++run;
    if (run < noise.order() || !usable(t)) continue;
    const double innovation = residual(t) - noise.ar.dot(residual.segment(t - noise.order(), noise.order()).reverse());
    sum += innovation * innovation;
    ++innovations;
  }
  if (innovations > 0) noise.std = std::max(std::sqrt(sum / innovations), 1e-300);
}

}  // namespace

double NoiseModel::total_std() const {
  double sum = 0;
  for (const double h : impulse_response(ar)) sum += h * h;
  return std * std::sqrt(sum);
}

PerLogAndDrive<NoiseModel> without_memory(PerLogAndDrive<NoiseModel> noise) {
  for (auto& log : noise) {
    for (NoiseModel& one : log) one = {{}, one.total_std()};
  }
  return noise;
}

NoiseModel with_white_share(const NoiseModel& noise, double share) {
  constexpr Index kLeastOrder = 8;  // an autoregression beside white noise has no finite order
  if (noise.order() == 0) return noise;
  const Index order = std::max(noise.order(), kLeastOrder);
  const std::vector<double> h = impulse_response(noise.ar);
  VectorXd covariance = VectorXd::Zero(order + 1);
  for (Index lag = 0; lag <= order; ++lag) {
    for (std::size_t k = static_cast<std::size_t>(lag); k < h.size(); ++k)
      covariance(lag) += h[k] * h[k - static_cast<std::size_t>(lag)];
  }
  covariance *= noise.std * noise.std / (1 + share);  // as large as before in all
  covariance(0) *= 1 + share;
  // Levinson's recursion for the autoregression with this covariance.
  NoiseModel out;
  out.ar.resize(0);
  double power = covariance(0);
  for (Index m = 1; m <= order; ++m) {
    double reflection = covariance(m);
    for (Index k = 0; k < m - 1; ++k) reflection -= out.ar(k) * covariance(m - 1 - k);
    reflection /= power;
    out.ar = extended(out.ar, reflection);
    power *= 1 - reflection * reflection;
  }
  out.std = std::sqrt(power);
  return out;
}

NoiseModel fit_noise_model(const Eigen::Ref<const VectorXd>& residual, const RowMask& usable, Index largest_order,
                           double damping) {
  // Forward and backward errors of each run of usable rows (Burg 1968).
  struct Run {
    VectorXd forward, backward;
  };
  std::vector<Run> runs;
  Index count = 0;
  for (Index t = 0; t < residual.size();) {
    Index end = t;
    while (end < residual.size() && usable(end)) ++end;
    if (end > t) {
      runs.push_back({residual.segment(t, end - t), residual.segment(t, end - t)});
      count += end - t;
    }
    t = end + 1;
  }
  NoiseModel best;
  if (count < 4) return best;
  double power = 0;
  for (const Run& run : runs) power += run.forward.squaredNorm();
  power = std::max(power / static_cast<double>(count), 1e-300);
  best.std = std::sqrt(power);
  const double log_count = std::log(static_cast<double>(count));
  double best_score = static_cast<double>(count) * std::log(power);
  VectorXd ar(0);
  for (Index order = 1; order <= std::min(largest_order, count / 20); ++order) {
    double cross = 0, square = 0;
    Index pairs = 0;
    for (Run& run : runs) {
      const Index length = run.forward.size() - 1;
      if (length < 1) {
        run.forward.resize(0);
        continue;
      }
      // forward error at t beside the backward error at t - 1
      cross += run.forward.tail(length).dot(run.backward.head(length));
      square += run.forward.tail(length).squaredNorm() + run.backward.head(length).squaredNorm();
      pairs += length;
    }
    // Short runs have no more to say: the few long ones would be followed, not modelled.
    if (!(square > 0) || kLeastPairs * pairs < count) break;
    const double reflection = 2 * cross / square;
    for (Run& run : runs) {
      const Index length = run.forward.size() - 1;
      if (length < 1) continue;
      const VectorXd f = run.forward.tail(length), b = run.backward.head(length);
      run.forward = f - reflection * b;
      run.backward = b - reflection * f;
    }
    ar = extended(ar, reflection);
    power *= std::max(1 - reflection * reflection, 1e-12);
    const double score = static_cast<double>(count) * std::log(power) + static_cast<double>(order) * log_count;
    if (score < best_score) {
      best_score = score;
      best.ar = ar;
      best.std = std::sqrt(power);
    }
  }
  if (damping < 1 && best.order() > 0) damp(damping, residual, usable, best);
  return best;
}

}  // namespace deltadyn
