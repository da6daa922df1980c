#include "deltadyn/signal/fourier.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/statistics.hpp"
#include "deltadyn/signal/resample.hpp"
#include "deltadyn/signal/reversal_mask.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using std::numbers::pi;

constexpr double kNoiseRatio = 4.0;  // positions one period apart differ by at most this many times their noise,
// Or this share of the drive's range (real drives do not repeat to the last count)
constexpr double kShareOfRange = 3e-4;
constexpr int kFewestPeriods = 2;  // a period seen fewer times is no period

/// Basis functions at the given times, times x (1 + 2 harmonics).
Eigen::MatrixXd basis(const Eigen::Ref<const Eigen::VectorXd>& t_s, double base_frequency_hz, int harmonics,
                      int derivative) {
  Eigen::MatrixXd result(t_s.size(), 1 + 2 * harmonics);
  result.col(0).setConstant(derivative == 0 ? 1.0 : 0.0);
  for (int k = 1; k <= harmonics; ++k) {
    const double omega = 2.0 * pi * base_frequency_hz * k;
    // Each derivative advances the phase by a quarter turn.
    const double scale = std::pow(omega, derivative);
    const double advance = 0.5 * pi * derivative;
    result.col(2 * k - 1) = scale * (omega * t_s.array() + advance).cos();
    result.col(2 * k) = scale * (omega * t_s.array() + advance).sin();
  }
  return result;
}

/// Whole periods in the log; the last one ends a sample time after the last sample.
int whole_periods(const Log& log, double period_s) {
  const double duration = static_cast<double>(log.samples()) * log.sample_time_s();
  return static_cast<int>(std::floor(duration / period_s + 1e-6));
}

struct Mismatch {
  double rms_over_allowed = 0.0;  ///< largest over the drives
  double shift_s = 0.0;           ///< to be added to the lag, for the best match
};

/// Positions `lag` samples apart, after the best shift in time below a sample.
Mismatch mismatch(const Log& log, Index lag, const Eigen::VectorXd& allowed) {
  const Index n = log.samples();
  const double h = log.sample_time_s();
  const Index count = n - lag - 2;
  double along = 0, square = 0;
  Mismatch result;
  const auto difference = [&](Index d) {
    return log.q.col(d).segment(1 + lag, count) - log.q.col(d).segment(1, count);
  };
  const auto rate = [&](Index d) {
    return (log.q.col(d).segment(2 + lag, count) - log.q.col(d).segment(lag, count)) / (2.0 * h);
  };
  for (Index d = 0; d < log.drives(); ++d) {
    const double weight = 1.0 / (allowed(d) * allowed(d));
    along += weight * rate(d).dot(difference(d));
    square += weight * rate(d).squaredNorm();
  }
  result.shift_s = square > 0 ? std::clamp(-along / square, -h, h) : 0.0;
  for (Index d = 0; d < log.drives(); ++d) {
    const double rms = root_mean_square(difference(d) + result.shift_s * rate(d));
    result.rms_over_allowed = std::max(result.rms_over_allowed, rms / allowed(d));
  }
  return result;
}

}  // namespace

Eigen::MatrixXd FourierFit::evaluate(const Eigen::Ref<const Eigen::VectorXd>& t_s, int derivative) const {
  return basis(t_s, base_frequency_hz, harmonics, derivative) * coefficients;
}

FourierFit fit_fourier(const Eigen::Ref<const Eigen::VectorXd>& t_s, const Eigen::Ref<const Eigen::MatrixXd>& columns,
                       double base_frequency_hz, int harmonics) {
  const Index unknowns = 1 + 2 * harmonics;
  if (!(base_frequency_hz > 0) || harmonics < 0 || t_s.size() <= unknowns || columns.rows() != t_s.size()) {
    throw Error("a Fourier fit needs a positive frequency and more samples than coefficients", "Fourier fit",
                "lower the number of harmonics", ExitCode::usage);
  }
  FourierFit fit;
  fit.base_frequency_hz = base_frequency_hz;
  fit.harmonics = harmonics;
  // Over whole periods the basis is orthogonal, so the normal equations lose nothing. Blocks keep the memory small.
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(unknowns, columns.cols());
  constexpr Index kBlock = 2048;
  for (Index from = 0; from < t_s.size(); from += kBlock) {
    const Index rows = std::min(kBlock, t_s.size() - from);
    const Eigen::MatrixXd a = basis(t_s.segment(from, rows), base_frequency_hz, harmonics, 0);
    normal.selfadjointView<Eigen::Lower>().rankUpdate(a.transpose());
    right.noalias() += a.transpose() * columns.middleRows(from, rows);
  }
  const Eigen::LDLT<Eigen::MatrixXd> factor(normal.selfadjointView<Eigen::Lower>());
  if (factor.rcond() < 1e-12) {
    throw Error("the samples do not determine the harmonics", "Fourier fit",
                "give at least one whole period, or fewer harmonics", ExitCode::usage);
  }
  fit.coefficients = factor.solve(right);
  return fit;
}

std::optional<Period> find_period(const Log& log) {
  const Index n = log.samples();
  const Index longest = n / kFewestPeriods + 1;
  if (n < 20) return std::nullopt;
  const double h = log.sample_time_s();
  Eigen::VectorXd allowed(log.drives()), deviation(log.drives()), fastest(log.drives());
  for (Index d = 0; d < log.drives(); ++d) {
    const auto q = log.q.col(d);
    const double range = q.maxCoeff() - q.minCoeff();
    if (!(range > 0)) {
      allowed(d) = deviation(d) = fastest(d) = std::numeric_limits<double>::infinity();
      continue;
    }
    // The difference of two noisy values has sqrt(2) of the noise.
    allowed(d) = std::max(kNoiseRatio * std::numbers::sqrt2 * position_noise(q), kShareOfRange * range);
    deviation(d) = std::sqrt((q.array() - q.mean()).square().mean());
    fastest(d) = (q.tail(n - 1) - q.head(n - 1)).cwiseAbs().maxCoeff();
  }
  if (!deviation.array().isFinite().any()) return std::nullopt;

  // A few samples reject most lags: none may differ by more than its noise and a shift below one sample explain.
  constexpr Index kProbes = 64;
  const auto rejected = [&](Index lag) {
    for (Index probe = 0; probe < kProbes; ++probe) {
      const Index i = probe * (n - lag - 1) / kProbes;
      for (Index d = 0; d < log.drives(); ++d) {
        if (std::abs(log.q(i + lag, d) - log.q(i, d)) > 5.0 * allowed(d) + fastest(d)) return true;
      }
    }
    return false;
  };
  // Short lags match because a motion is smooth, not because it repeats: start where the motion has left its place.
  bool left = false;
  std::optional<Period> best;
  double best_score = 1.0;
  for (Index lag = 2; lag <= std::min(longest, n - 4); ++lag) {
    if (!left) {
      double square = 0;
      for (Index probe = 0; probe < kProbes; ++probe) {
        const Index i = probe * (n - lag - 1) / kProbes;
        square = std::max(
            square, ((log.q.row(i + lag) - log.q.row(i)).transpose().array() / deviation.array()).abs().maxCoeff());
      }
      left = square > 1.0;
      continue;
    }
    if (rejected(lag)) {
      if (best) break;  // the neighbours of a match have been compared
      continue;
    }
    const Mismatch match = mismatch(log, lag, allowed);
    if (match.rms_over_allowed < best_score) {
      best_score = match.rms_over_allowed;
      best = Period{static_cast<double>(lag) * h + match.shift_s, 0};
    }
  }
  if (!best) return std::nullopt;
  // Over many periods the same comparison measures the period more finely.
  for (int times = 2; times <= whole_periods(log, best->period_s); times *= 2) {
    const auto lag = static_cast<Index>(std::lround(times * best->period_s / h));
    if (lag > n - 20) break;
    best->period_s = (static_cast<double>(lag) * h + mismatch(log, lag, allowed).shift_s) / times;
  }
  // A whole number of samples to within the accuracy is meant to be one.
  const double samples = best->period_s / h;
  if (std::abs(samples - std::round(samples)) < 0.02) best->period_s = std::round(samples) * h;
  best->whole_periods = whole_periods(log, best->period_s);
  if (best->whole_periods < kFewestPeriods) return std::nullopt;
  return best;
}

PeriodMean average_periods(const Log& log, double period_s, int harmonics) {
  const double h = log.sample_time_s();
  PeriodMean mean;
  mean.periods = period_s > 0 ? whole_periods(log, period_s) : 0;
  if (mean.periods < 2) {
    throw Error("the log holds fewer than two whole periods", log.file, "record more periods, or do not average",
                ExitCode::bad_input);
  }
  const auto count = std::min(log.samples(), static_cast<Index>(std::lround(mean.periods * period_s / h)));
  const Eigen::VectorXd t_s = log.t_s.array() - log.t_s(0);
  mean.series = fit_fourier(t_s.head(count), log.q.topRows(count), 1.0 / period_s, harmonics);

  const auto points = static_cast<Index>(std::lround(period_s / h));
  Log& one = mean.log;
  one.file = log.file;
  one.t_s =
      Eigen::VectorXd::LinSpaced(points, 0.0, period_s * static_cast<double>(points - 1) / static_cast<double>(points));
  one.q = mean.series.evaluate(one.t_s, 0);
  one.qd = mean.series.evaluate(one.t_s, 1);
  one.qdd = mean.series.evaluate(one.t_s, 2);
  one.notes = log.notes;
  if (log.tau.size() == 0) return mean;

  const bool whole_samples = std::abs(period_s / h - static_cast<double>(points)) < 1e-6;
  const Index drives = log.drives();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(points, drives), used = sum;
  const Eigen::RowVectorXd reference = log.tau.colwise().mean();
  for (int period = 0; period < mean.periods; ++period) {
    const Eigen::VectorXd when = one.t_s.array() + period * period_s;
    const Eigen::MatrixXd tau =
        whole_samples ? log.tau.middleRows(period * points, points).eval() : resample(t_s, log.tau, when);
    for (Index i = 0; i < points; ++i) {
      const Index nearest = std::min(log.samples() - 1, static_cast<Index>(std::lround(when(i) / h)));
      if (log.is_filled(nearest)) continue;
      for (Index d = 0; d < drives; ++d) {
        if (log.torque_out.size() > 0 && log.torque_out(nearest, d)) continue;
        sum(i, d) += tau(i, d) - reference(d);
        used(i, d) += 1.0;
      }
    }
  }
  one.tau = sum.cwiseQuotient(used.cwiseMax(1.0)).rowwise() + reference;
  const auto missing = (used.array() < 1.0).eval();
  if (missing.any()) one.torque_out = missing;
  for (Index i = 0; i < points; ++i) {
    if (!missing.row(i).all()) continue;
    one.filled.resize(static_cast<std::size_t>(points), Log::kMeasured);
    one.filled[static_cast<std::size_t>(i)] = Log::kLeftOut;
  }
  return mean;
}

}  // namespace deltadyn
