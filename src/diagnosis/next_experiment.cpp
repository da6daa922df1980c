#include "deltadyn/diagnosis/next_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <random>
#include <vector>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/random.hpp"
#include "deltadyn/runtime/statistics.hpp"
#include "deltadyn/trajectory/motion_plan.hpp"

#include "search/hypothesis.hpp"

namespace deltadyn {

namespace {

constexpr int kHarmonics = 5;
constexpr int kRandomMotions = 40;
constexpr int kImprovements = 120;
constexpr double kPeriod_s = 5;
constexpr int kStates = 500;    // of a period, for the criterion
constexpr double kRoom = 0.95;  // of the recorded envelope
constexpr double kRate_hz = 1000;

/// What the logs have shown the machine to bear.
struct Envelope {
  VectorXd z_low, z_high, qd, qdd;
};

Envelope envelope_of(const Robot& robot, const Diagnosis& diagnosis) {
  const Index n = robot.drives();
  Envelope out{VectorXd::Constant(n, 1e300), VectorXd::Constant(n, -1e300), VectorXd::Zero(n), VectorXd::Zero(n)};
  VectorXd z(n);
  for (const DiagnosisTrace& trace : diagnosis.traces) {
    if (trace.holdout) continue;
    for (Index k = 0; k < trace.t_s.size(); ++k) {
      if (robot.forward_kinematics(trace.q.row(k).transpose(), z) != Status::ok) continue;
      out.z_low = out.z_low.cwiseMin(z);
      out.z_high = out.z_high.cwiseMax(z);
      out.qd = out.qd.cwiseMax(trace.qd.row(k).transpose().cwiseAbs());
      if (k > 0) {
        const double dt = trace.t_s(k) - trace.t_s(k - 1);
        out.qdd = out.qdd.cwiseMax((trace.qd.row(k) - trace.qd.row(k - 1)).transpose().cwiseAbs() / dt);
      }
    }
  }
  return out;
}

class Separation {
 public:
  Separation(const Robot& robot, const Diagnosis& diagnosis, const VectorXd& p)
      : robot_(robot),
        model_(robot),
        base_(find_base_parameters(robot)),
        diagnosis_(diagnosis),
        p_(p),
        best_(diagnosis.named.front()) {}

  /// Smallest distance of an alternative to the best effect, rms in units of the noise; negative: the motion cannot be
  /// run.
  [[nodiscard]] double of(const FourierSeries& series, const Envelope& envelope) const {
    const Index n = robot_.drives();
    PreparedLog log;
    log.rate_hz = kStates * series.base_frequency_hz;
    log.rows = kStates;
    const VectorXd phases = even_phases(kStates);
    const MatrixXd z = series.at_phases(phases, 0), zd = series.at_phases(phases, 1), zdd = series.at_phases(phases, 2);
    log.t_s = VectorXd::LinSpaced(kStates, 0, (kStates - 1) / log.rate_hz);
    for (MatrixXd* m : {&log.q, &log.qd, &log.qdd, &log.tau}) m->setZero(kStates, n);
    VectorXd q(n), qd(n), qdd(n);
    for (Index k = 0; k < kStates; ++k) {
      const TaskState task{z.row(k).transpose(), zd.row(k).transpose(), zdd.row(k).transpose()};
      if (robot_.to_drives(task, q, qd, qdd) != Status::ok) return -1;
      for (Index j = 0; j < n; ++j) {
        if (std::abs(qd(j)) > envelope.qd(j) || std::abs(qdd(j)) > envelope.qdd(j)) return -1;
        if (z(k, j) < envelope.z_low(j) || z(k, j) > envelope.z_high(j)) return -1;
      }
      log.q.row(k) = q.transpose();
      log.qd.row(k) = qd.transpose();
      log.qdd.row(k) = qdd.transpose();
    }
    LogRows rows;
    rows.log = log;
    rows.number = 1;
    rows.tau.setZero(kStates, n);
    const EffectSignals signals = model_.signals(log, p_);
    const std::vector<MatrixXd> Y = base_rows(robot_, base_, log);
    const Index b = base_.count(), k_best = best_.effect.amplitude.size();
    MatrixXd X(n * kStates, b + k_best);
    const std::vector<MatrixXd> C = rows_of(rows, signals, best_.effect);
    for (Index j = 0; j < n; ++j) {
      const auto drive = static_cast<std::size_t>(j);
      const double weight = 1.0 / std::max(diagnosis_.drives[drive].floor, 1e-12);
      X.middleRows(j * kStates, kStates) << weight * Y[drive], weight * C[drive];
    }
    const MatrixXd Q = dense::PivotedQr(X).basis();
    double least = 1e300;
    for (const EffectCandidate& other : best_.confusable) {
      const std::vector<MatrixXd> D = rows_of(rows, signals, other.effect);
      VectorXd s(n * kStates);
      for (Index j = 0; j < n; ++j) {
        const auto drive = static_cast<std::size_t>(j);
        s.segment(j * kStates, kStates) =
            D[drive] * other.effect.amplitude / std::max(diagnosis_.drives[drive].floor, 1e-12);
      }
      least = std::min(least, (s - Q * (Q.transpose() * s)).norm() / std::sqrt(static_cast<double>(kStates)));
    }
    return least;
  }

 private:
  [[nodiscard]] std::vector<MatrixXd> rows_of(const LogRows& rows, const EffectSignals& signals,
                                              const Effect& effect) const {
    std::vector<MatrixXd> out = hypothesis_rows(model_, rows, signals, hypothesis_of(effect));
    for (MatrixXd& drive : out) {
      if (drive.size() == 0) drive.setZero(kStates, effect.amplitude.size());
    }
    return out;
  }

  const Robot& robot_;
  EffectModel model_;
  BaseParameters base_;
  const Diagnosis& diagnosis_;
  VectorXd p_;
  const NamedEffect& best_;
};

/// A series around the middle of the envelope, as large as it fits.
std::optional<FourierSeries> fitted(FourierSeries series, const Separation& separation, const Envelope& envelope,
                                    double& value) {
  const VectorXd centre = series.coefficients.row(0).transpose();
  double factor = 1;
  for (int step = 0; step < 25; ++step) {
    const FourierSeries smaller = series.scaled(centre, factor);
    value = separation.of(smaller, envelope);
    if (value >= 0) return smaller;
    factor *= 0.8;
  }
  return std::nullopt;
}

/// Random steps of shrinking size that keep what gains. Returns the separation that `best` then has.
double improve(FourierSeries& best, const VectorXd& half, const Separation& separation, const Envelope& envelope,
               double value_of_best, std::mt19937_64& random) {
  NormalDistribution normal;
  double step = 0.2;
  for (int k = 0; k < kImprovements; ++k) {
    FourierSeries trial = best;
    for (Index c = 1; c < trial.coefficients.rows(); ++c) {
      for (Index j = 0; j < trial.coefficients.cols(); ++j)
        trial.coefficients(c, j) += step * 0.3 * half(j) * normal(random);
    }
    const double value = separation.of(trial, envelope);
    if (value > value_of_best) {
      value_of_best = value;
      best = trial;
    } else {
      step = std::max(0.01, 0.98 * step);
    }
  }
  return value_of_best;
}

}  // namespace

std::optional<NextExperiment> plan_next_experiment(const Robot& robot, const Diagnosis& diagnosis, const VectorXd& p,
                                                   std::uint64_t seed) {
  if (diagnosis.named.empty() || diagnosis.named.front().confusable.empty()) return std::nullopt;
  Envelope envelope = envelope_of(robot, diagnosis);
  const Separation separation(robot, diagnosis, p);
  const VectorXd centre = 0.5 * (envelope.z_low + envelope.z_high),
                 half = 0.5 * kRoom * (envelope.z_high - envelope.z_low);
  envelope.qd *= kRoom;
  envelope.qdd *= kRoom;
  std::mt19937_64 random(seed);
  NormalDistribution normal;
  UniformDistribution uniform(0.4, 1.0);
  std::optional<FourierSeries> best;
  double best_value = -1;
  std::vector<double> values;
  for (int k = 0; k < kRandomMotions; ++k) {
    FourierSeries series;
    series.base_frequency_hz = 1 / kPeriod_s;
    series.coefficients = MatrixXd::Zero(1 + 2 * kHarmonics, robot.drives());
    series.coefficients.row(0) = centre.transpose();
    for (Index c = 1; c < series.coefficients.rows(); ++c) {
      for (Index j = 0; j < series.coefficients.cols(); ++j)
        series.coefficients(c, j) = 0.4 * uniform(random) * half(j) * normal(random);
    }
    double value = -1;
    const std::optional<FourierSeries> feasible = fitted(series, separation, envelope, value);
    if (!feasible) continue;
    values.push_back(value);
    if (value > best_value) {
      best_value = value;
      best = feasible;
    }
  }
  if (!best) {
    throw Error("no motion within the recorded speeds was found that separates the effects", "--plan-next",
                "record a log with larger motion", ExitCode::no_convergence);
  }
  best_value = improve(*best, half, separation, envelope, best_value, random);
  MotionLimits limits(robot.description());
  limits.qd = limits.qd.cwiseMin(envelope.qd / kRoom * 1.02);
  limits.qdd = limits.qdd.cwiseMin(envelope.qdd / kRoom * 1.05);
  NextExperiment out;
  const PlanSegment segment{on_sample_grid(*best, kRate_hz), limits, 2};
  out.samples = sample_plan(robot, make_plan(robot, {segment}, kRate_hz, false), kRate_hz);
  std::vector<std::string> others;
  for (const EffectCandidate& other : diagnosis.named.front().confusable) others.push_back(other.name);
  out.note = fmt::format(
      "motion of {:.1f} s that tells {} from {}: their torques differ by {:.2g} noise standard deviations (random "
      "motions {:.2g})",
      out.samples.t_s(out.samples.samples() - 1), diagnosis.named.front().name, fmt::join(others, ", "), best_value,
      upper_median(values));
  return out;
}

}  // namespace deltadyn
