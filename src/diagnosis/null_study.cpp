#include "deltadyn/diagnosis/null_study.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <numbers>
#include <omp.h>
#include <random>

#include "deltadyn/signal/butterworth.hpp"
#include "deltadyn/signal/differentiate.hpp"

namespace deltadyn {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kTailShare = 0.25;    // of the runs that the tail is fitted to
constexpr int kTrialRuns = 3;          // to tell which columns encoder noise moves
constexpr int kPilotRuns = 12;         // to average what it fakes
constexpr double kSensitive = 0.01;    // change of a column, as a share of its size, that counts
constexpr double kLeastTorque = 0.05;  // share of the spectrum that is the torque's own at least
constexpr Index kSpectrumLags = 24;

/// A motion with encoder noise, through the same zero-phase filter as the log's own.
PreparedLog noisy_motion(const PreparedLog& log, const std::vector<double>& sigma, double cutoff_hz, std::mt19937_64& random) {
  PreparedLog out = log;
  std::normal_distribution<double> normal;
  MatrixXd noise(log.q.rows(), log.q.cols());
  for (Index j = 0; j < noise.cols(); ++j) {
    for (Index k = 0; k < noise.rows(); ++k) noise(k, j) = sigma[static_cast<std::size_t>(j)] * normal(random);
  }
  noise = zero_phase_filter(noise, log.rate_hz, cutoff_hz, 4);
  out.q += noise;
  out.qd += differentiate(noise, 1.0 / log.rate_hz, 1, 3);
  out.qdd += differentiate(noise, 1.0 / log.rate_hz, 2, 3);
  return out;
}

/// Largest change of any column of `b` beside `a`, as a share of its size.
double change(const MatrixXd& a, const MatrixXd& b) {
  double largest = 0;
  for (Index c = 0; c < a.cols(); ++c)
    largest = std::max(largest, (a.col(c) - b.col(c)).norm() / std::max(a.col(c).norm(), 1e-300));
  return largest;
}

}  // namespace

NullDistribution::NullDistribution(std::vector<double> values) : sorted_(std::move(values)) {
  std::sort(sorted_.begin(), sorted_.end());
  if (sorted_.empty()) return;
  const auto first = static_cast<std::size_t>((1 - kTailShare) * static_cast<double>(sorted_.size()));
  knee_ = sorted_[std::min(first, sorted_.size() - 1)];
  double sum = 0;
  for (std::size_t k = first; k < sorted_.size(); ++k) sum += sorted_[k] - knee_;
  slope_ = std::max(sum / static_cast<double>(std::max<std::size_t>(1, sorted_.size() - first)), 1e-9);
}

double NullDistribution::p_value(double score) const {
  if (sorted_.empty()) return 1;
  if (score > knee_) return kTailShare * std::exp(-(score - knee_) / slope_);
  const auto below = static_cast<double>(std::lower_bound(sorted_.begin(), sorted_.end(), score) - sorted_.begin());
  return std::max(kTailShare, 1.0 - below / static_cast<double>(sorted_.size()));
}

double NullDistribution::quantile(double p) const {
  if (sorted_.empty()) return std::numeric_limits<double>::infinity();
  if (p < kTailShare) return knee_ + slope_ * std::log(kTailShare / p);
  return sorted_[static_cast<std::size_t>(
      std::min((1 - p) * static_cast<double>(sorted_.size()), static_cast<double>(sorted_.size() - 1)))];
}

double NullStudy::family_p(std::size_t index, double score) const {
  const double p = std::max(hypothesis[index].p_value(score), 1e-300);
  return std::min(1.0, family.p_value(-std::log(p)));
}

double NullStudy::omnibus_p(const VectorXd& gains) const {
  double least = 1;
  for (std::size_t j = 0; j < omnibus.size(); ++j) least = std::min(least, omnibus[j].p_value(gains(static_cast<Index>(j))));
  return std::min(1.0, omnibus_family.p_value(-std::log(std::max(least, 1e-300))));
}

Omnibus::Omnibus(const WhiteProblem& problem, const GenericBasis& basis) : coordinate_(basis.coordinate) {
  const std::size_t n = basis.coordinate.size();
  for (std::size_t j = 0; j < n; ++j) {
    PerLogAndDrive<MatrixXd> columns(basis.columns.size(), std::vector<MatrixXd>(n));
    for (std::size_t l = 0; l < basis.columns.size(); ++l) columns[l][j] = basis.columns[l][j];
    white_.push_back(problem.whiten(columns));
    MatrixXd G = white_.back().gram(0, white_.back().cols);
    const VectorXd raw = white_.back().raw_gram(0, white_.back().cols).diagonal().cwiseMax(1e-300);
    const VectorXd scale = raw.cwiseSqrt().cwiseInverse();
    G = scale.asDiagonal() * G * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(G);
    const VectorXd& values = eigen.eigenvalues();
    std::vector<Index> kept;
    for (Index k = 0; k < values.size(); ++k) {
      if (values(k) > 1e-4 * values.maxCoeff()) kept.push_back(k);
    }
    MatrixXd root(values.size(), static_cast<Index>(kept.size()));
    for (std::size_t k = 0; k < kept.size(); ++k) {
      root.col(static_cast<Index>(k)) = scale.asDiagonal() * eigen.eigenvectors().col(kept[k]) / std::sqrt(values(kept[k]));
    }
    root_.push_back(root);
    ranks_.push_back(root.cols());
  }
}

VectorXd Omnibus::gains(const WhiteProblem& problem, const VectorXd& r) const {
  const VectorXd Q_r = problem.Q.transpose() * r;
  VectorXd out(static_cast<Index>(white_.size()));
  for (std::size_t j = 0; j < white_.size(); ++j) {
    const VectorXd u = white_[j].inner(r, Q_r, problem.segments, 0, white_[j].cols);
    out(static_cast<Index>(j)) = (root_[j].transpose() * u).squaredNorm();
  }
  return out;
}

std::vector<std::pair<std::string, double>> Omnibus::by_coordinate(const WhiteProblem& problem, const VectorXd& r,
                                                                   std::size_t drive) const {
  std::vector<std::pair<std::string, double>> out;
  const VectorXd Q_r = problem.Q.transpose() * r;
  const WhiteColumns& white = white_[drive];
  const auto& names = coordinate_[drive];
  for (std::size_t first = 0; first < names.size();) {
    std::size_t end = first;
    while (end < names.size() && names[end] == names[first]) ++end;
    const auto at = static_cast<Index>(first), count = static_cast<Index>(end - first);
    const Gain gain = constrained_gain(white.gram(at, count), white.inner(r, Q_r, problem.segments, at, count),
                                       std::vector<bool>(end - first, false));
    // What chance alone gives each column is taken off.
    out.emplace_back(names[first], std::max(0.0, gain.gain - static_cast<double>(count)));
    first = end;
  }
  return out;
}

std::vector<PreparedLog> EncoderPilots::motion(std::uint64_t seed) const {
  std::mt19937_64 random(seed);
  std::vector<PreparedLog> out;
  for (std::size_t l = 0; l < logs_.size(); ++l)
    out.push_back(noisy_motion(logs_[l].log, position_noise_[l], cutoff_hz_, random));
  return out;
}

void EncoderPilots::rows_of(const std::vector<PreparedLog>& motion, const std::vector<std::size_t>& which, Run& run) const {
  run.rows.assign(which.size(), {});
  if (which.empty()) return;
  for (std::size_t l = 0; l < logs_.size(); ++l) {
    const EffectSignals signals = model_.signals(motion[l], p_, false);
    for (std::size_t k = 0; k < which.size(); ++k) {
      run.rows[k].push_back(hypothesis_rows(model_, logs_[l], signals, hypotheses_[which[k]]));
    }
  }
}

EncoderPilots::Run EncoderPilots::draw(std::uint64_t seed) const {
  Run run;
  const std::vector<PreparedLog> noisy = motion(seed);
  for (const PreparedLog& log : noisy) run.Y.push_back(base_rows(model_.robot(), base_, log));
  rows_of(noisy, sensitive_, run);
  return run;
}

EncoderPilots::EncoderPilots(const EffectModel& model, const BaseParameters& base, const std::vector<LogRows>& logs,
                             const VectorXd& p, const std::vector<Hypothesis>& hypotheses,
                             const PerLogAndDrive<double>& position_noise, double cutoff_hz, std::uint64_t seed, int threads)
    : model_(model),
      base_(base),
      logs_(logs),
      p_(p),
      hypotheses_(hypotheses),
      position_noise_(position_noise),
      cutoff_hz_(cutoff_hz) {
  std::vector<std::size_t> candidates;
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    // Columns of pose alone: a few encoder counts do nothing there.
    const EffectId id = hypotheses[h].id;
    if (id != EffectId::base_tilt && id != EffectId::kinematic_offset && id != EffectId::hose_force) candidates.push_back(h);
  }
  std::vector<char> feels(hypotheses.size(), 0);
  const int team = threads > 0 ? threads : omp_get_max_threads();
#pragma omp parallel for schedule(dynamic) num_threads(team)
  for (int k = 0; k < kTrialRuns; ++k) {
    Run run, still;
    std::vector<PreparedLog> own;
    for (const LogRows& log : logs_) own.push_back(log.log);
    rows_of(motion(seed * 1000003U + static_cast<std::uint64_t>(k)), candidates, run);
    rows_of(own, candidates, still);
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      for (std::size_t l = 0; l < logs_.size(); ++l) {
        for (std::size_t j = 0; j < run.rows[c][l].size(); ++j) {
          const MatrixXd &a = still.rows[c][l][j], &b = run.rows[c][l][j];
          if (a.size() == 0) continue;
          const VectorXd use = logs_[l].usable[j].cast<double>();
          if (change(use.asDiagonal() * a, use.asDiagonal() * b) > kSensitive) {
#pragma omp atomic write
            feels[candidates[c]] = 1;
          }
        }
      }
    }
  }
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    if (feels[h]) sensitive_.push_back(h);
  }
  runs_.resize(kPilotRuns);
#pragma omp parallel for schedule(dynamic) num_threads(team)
  for (int k = 0; k < kPilotRuns; ++k) runs_[static_cast<std::size_t>(k)] = draw(seed * 7727U + static_cast<std::uint64_t>(k));
}

VectorXd EncoderPilots::clean(const WhiteProblem& problem) const {
  const Index b = base_.count();
  return problem.X.leftCols(b) * problem.beta.head(b);
}

std::vector<VectorXd> EncoderPilots::products(const WhiteProblem& problem, const Run& run, const VectorXd& y, VectorXd& r) const {
  const Index b = base_.count();
  MatrixXd X = problem.X;
  for (const WhiteSegment& segment : problem.segments) {
    X.block(segment.offset, 0, segment.rows(), b) = segment.whitener.apply(run.Y[segment.log][segment.drive]);
  }
  const VectorXd scale = X.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  X = X * scale.asDiagonal();
  MatrixXd information = X.transpose() * X;
  information.diagonal().array() += 1e-12;
  r = y - X * information.ldlt().solve(X.transpose() * y);
  std::vector<VectorXd> out;
  for (const auto& rows : run.rows) {
    VectorXd inner;
    for (const WhiteSegment& segment : problem.segments) {
      const MatrixXd& raw = rows[segment.log][segment.drive];
      if (raw.size() == 0) continue;
      const VectorXd part = segment.whitener.apply(raw).transpose() * r.segment(segment.offset, segment.rows());
      inner = inner.size() == 0 ? part : VectorXd(inner + part);
    }
    out.push_back(inner);
  }
  return out;
}

std::vector<VectorXd> EncoderPilots::bias(const WhiteProblem& problem) const {
  std::vector<VectorXd> out(hypotheses_.size());
  const VectorXd y = clean(problem);
  for (const Run& run : runs_) {
    VectorXd r;
    const std::vector<VectorXd> inner = products(problem, run, y, r);
    for (std::size_t k = 0; k < sensitive_.size(); ++k) {
      VectorXd& sum = out[sensitive_[k]];
      if (sum.size() == 0) sum = VectorXd::Zero(inner[k].size());
      sum += inner[k] / static_cast<double>(runs_.size());
    }
  }
  return out;
}

std::vector<VectorXd> EncoderPilots::torque_noise(const WhiteProblem& problem, double& share) const {
  const VectorXd y = clean(problem);
  std::vector<VectorXd> covariance(problem.segments.size(), VectorXd::Zero(kSpectrumLags + 1));
  share = 0;
  for (const Run& run : runs_) {
    Run motion_only;
    motion_only.Y = run.Y;
    VectorXd r;
    (void)products(problem, motion_only, y, r);
    share += r.squaredNorm() / static_cast<double>(r.size()) / static_cast<double>(runs_.size());
    for (std::size_t s = 0; s < problem.segments.size(); ++s) {
      const VectorXd e = r.segment(problem.segments[s].offset, problem.segments[s].rows());
      for (Index lag = 0; lag <= std::min(kSpectrumLags, e.size() - 1); ++lag) {
        covariance[s](lag) += e.head(e.size() - lag).dot(e.tail(e.size() - lag)) /
                              static_cast<double>(std::max<Index>(1, e.size())) / static_cast<double>(runs_.size());
      }
    }
  }
  share = std::min(1.0, share);
  // Spectrum with a Bartlett window, its complement to one, and a symmetric filter with that gain.
  constexpr Index kGrid = 128;
  std::vector<VectorXd> taps;
  for (const VectorXd& c : covariance) {
    VectorXd filter = VectorXd::Zero(2 * kSpectrumLags + 1);
    for (Index f = 0; f < kGrid; ++f) {
      const double angle = std::numbers::pi * (static_cast<double>(f) + 0.5) / static_cast<double>(kGrid);
      double spectrum = c(0);
      for (Index lag = 1; lag <= kSpectrumLags; ++lag) {
        const double window = 1.0 - static_cast<double>(lag) / static_cast<double>(kSpectrumLags + 1);
        spectrum += 2 * window * c(lag) * std::cos(angle * static_cast<double>(lag));
      }
      const double gain = std::sqrt(std::max(kLeastTorque, 1 - spectrum));
      for (Index k = -kSpectrumLags; k <= kSpectrumLags; ++k) {
        filter(k + kSpectrumLags) += gain * std::cos(angle * static_cast<double>(k)) / static_cast<double>(kGrid);
      }
    }
    taps.push_back(filter);
  }
  return taps;
}

NullStudy run_null_study(const EncoderPilots& pilots, const WhiteProblem& problem, const std::vector<Hypothesis>& hypotheses,
                         const std::vector<Signature>& signatures, const std::vector<VectorXd>& bias, const Omnibus& omnibus,
                         const NullOptions& options) {
  NullStudy out;
  out.runs = options.runs;
  out.sensitive = static_cast<int>(pilots.sensitive().size());
  const VectorXd clean = pilots.clean(problem);
  const std::vector<VectorXd> taps = pilots.torque_noise(problem, out.encoder_share);
  const auto drives = static_cast<Index>(omnibus.ranks().size());
  MatrixXd scores = MatrixXd::Zero(options.runs, static_cast<Index>(hypotheses.size()));
  MatrixXd generic = MatrixXd::Zero(options.runs, drives);
  int done = 0;
  std::exception_ptr failure;
#pragma omp parallel for schedule(dynamic) num_threads(options.threads > 0 ? options.threads : omp_get_max_threads())
  for (int k = 0; k < options.runs; ++k) {
    try {
      const std::uint64_t seed = options.seed * 104729U + 15485863U * static_cast<std::uint64_t>(k + 1);
      std::mt19937_64 random(seed);
      std::normal_distribution<double> normal;
      VectorXd y = clean;
      for (std::size_t s = 0; s < problem.segments.size(); ++s) {
        const Index rows = problem.segments[s].rows();
        VectorXd white(rows + taps[s].size() - 1);
        for (double& w : white) w = normal(random);
        for (Index row = 0; row < rows; ++row)
          y(problem.segments[s].offset + row) += taps[s].dot(white.segment(row, taps[s].size()));
      }
      VectorXd r;
      const std::vector<VectorXd> sensitive = pilots.products(problem, pilots.draw(seed + 1), y, r);
      const VectorXd Q_r = problem.Q.transpose() * r;
      std::vector<VectorXd> inner(hypotheses.size());
      for (std::size_t c = 0; c < sensitive.size(); ++c) inner[pilots.sensitive()[c]] = sensitive[c];
      for (std::size_t h = 0; h < hypotheses.size(); ++h) {
        if (signatures[h].white.cols == 0) continue;
        if (inner[h].size() == 0) inner[h] = signatures[h].white.inner(r, Q_r, problem.segments, 0, signatures[h].white.cols);
        if (bias[h].size() > 0) inner[h] -= bias[h];
        scores(k, static_cast<Index>(h)) = best_score(hypotheses[h], signatures[h], inner[h]).gain;
      }
      generic.row(k) = omnibus.gains(problem, r).transpose();
    } catch (...) {
#pragma omp critical
      failure = std::current_exception();
    }
#pragma omp critical
    if (options.progress) options.progress(static_cast<double>(++done) / options.runs);
  }
  if (failure) std::rethrow_exception(failure);

  const auto column = [](const MatrixXd& m, Index c) { return std::vector<double>(m.col(c).begin(), m.col(c).end()); };
  for (Index h = 0; h < scores.cols(); ++h) out.hypothesis.emplace_back(column(scores, h));
  for (Index j = 0; j < generic.cols(); ++j) out.omnibus.emplace_back(column(generic, j));
  std::vector<double> smallest, smallest_generic;
  for (int k = 0; k < options.runs; ++k) {
    double least = 1, least_generic = 1;
    for (Index h = 0; h < scores.cols(); ++h)
      least = std::min(least, out.hypothesis[static_cast<std::size_t>(h)].p_value(scores(k, h)));
    for (Index j = 0; j < generic.cols(); ++j) {
      least_generic = std::min(least_generic, out.omnibus[static_cast<std::size_t>(j)].p_value(generic(k, j)));
    }
    smallest.push_back(-std::log(std::max(least, 1e-300)));
    smallest_generic.push_back(-std::log(std::max(least_generic, 1e-300)));
  }
  out.family = NullDistribution(smallest);
  out.omnibus_family = NullDistribution(smallest_generic);
  return out;
}

}  // namespace deltadyn
