#include "encoder_pilots.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/in_parallel.hpp"
#include "deltadyn/runtime/random.hpp"
#include "deltadyn/signal/butterworth.hpp"
#include "deltadyn/signal/differentiate.hpp"

namespace deltadyn {

namespace {

constexpr int kTrialRuns = 3;          // to tell which columns encoder noise moves
constexpr int kPilotRuns = 12;         // to average what it fakes
constexpr double kSensitive = 0.01;    // change of a column, as a share of its size, that counts
constexpr double kLeastTorque = 0.05;  // share of the spectrum that is the torque's own at least
constexpr Index kSpectrumLags = 24;
constexpr double kBiasDoubt = 0.3;   // share of a faked score that the noise's variance may be wrong by
constexpr double kLeastClean = 0.6;  // of a Gram matrix, left at least when the noise's own squares are taken off
constexpr std::size_t kGramRuns = 4;

/// A bristle does not turn with the sign of a noisy rate: the share of Coulomb's friction is given the sign that was
/// taken out of it.
void keep_bristles(const Robot& robot, const PreparedLog& before, PreparedLog& log) {
  if (log.coulomb_share.size() == 0) return;
  const Eigen::Array<bool, 1, Eigen::Dynamic> bristle = (log.coulomb_share.array() != 1.0).colwise().any();
  VectorXd own(robot.friction_joints()), noisy = own;
  PathPose path;
  for (Index k = 0; k < log.q.rows(); ++k) {
    if (robot.friction_joint_rates(before.q.row(k).transpose(), before.qd.row(k).transpose(), own, &path) !=
            Status::ok ||
        robot.friction_joint_rates(log.q.row(k).transpose(), log.qd.row(k).transpose(), noisy, &path) != Status::ok)
      continue;
    for (Index joint = 0; joint < own.size(); ++joint) {
      if (bristle(joint) && own(joint) * noisy(joint) < 0) log.coulomb_share(k, joint) *= -1;
    }
  }
}

}  // namespace

/// The motion of a log at every `step`-th sample, so that its rows stay where they are. The log must have a few samples
/// to spare before its first row and after its last one, as the coarser low pass may be longer by one step.
EncoderPilots::Thinned EncoderPilots::thinned(const LogRows& from, double low_pass_hz) {
  Thinned out;
  out.number = from.number;
  out.samples = from.log.t_s.size();
  out.rate_hz = from.log.rate_hz;
  out.tau.resize(from.rows(), from.tau.cols());
  PreparedLog& log = out.log;
  log = from.log;
  // The rows' stride must be a whole number of steps.
  for (const Index candidate : {Index{4}, Index{3}, Index{2}}) {
    if (log.low_pass && log.stride % candidate == 0 &&
        log.rate_hz / static_cast<double>(candidate) >= 5 * low_pass_hz) {
      out.step = candidate;
      break;
    }
  }
  const Index step = out.step, start = log.first % step;
  out.start = start;
  if (step == 1) return out;
  const Index samples = (log.t_s.size() - start + step - 1) / step;
  const auto rows = [&](const MatrixXd& m) {
    MatrixXd thin(samples, m.cols());
    for (Index k = 0; k < samples; ++k) thin.row(k) = m.row(start + k * step);
    return thin;
  };
  for (MatrixXd* m : {&log.q, &log.qd, &log.qdd, &log.tau}) *m = rows(*m);
  if (log.coulomb_share.size() > 0) log.coulomb_share = rows(log.coulomb_share);
  log.t_s = rows(log.t_s);
  log.first = (log.first - start) / step;
  log.stride /= step;
  log.rate_hz /= static_cast<double>(step);
  log.low_pass = std::make_shared<FirDecimator>(log.rate_hz, low_pass_hz, static_cast<int>(log.stride));
  return out;
}

std::vector<PreparedLog> EncoderPilots::motion(std::uint64_t seed) const {
  std::mt19937_64 random(seed);
  NormalDistribution normal;
  std::vector<PreparedLog> out;
  for (std::size_t l = 0; l < logs_.size(); ++l) {
    PreparedLog log = logs_[l].log;
    const double rate_hz = logs_[l].rate_hz;
    MatrixXd noise(logs_[l].samples, log.q.cols());
    for (Index j = 0; j < noise.cols(); ++j) {
      for (Index k = 0; k < noise.rows(); ++k)
        noise(k, j) = position_noise_[l][static_cast<std::size_t>(j)] * normal(random);
    }
    // Through the same zero-phase filter and differentiation as the log's own motion.
    noise = zero_phase_filter(noise, rate_hz, cutoff_hz_, 4);
    const MatrixXd rate = differentiate(noise, 1.0 / rate_hz, 1, 3), second = differentiate(noise, 1.0 / rate_hz, 2, 3);
    for (Index k = 0; k < log.q.rows(); ++k) {
      const Index sample = logs_[l].start + k * logs_[l].step;
      log.q.row(k) += noise.row(sample);
      log.qd.row(k) += rate.row(sample);
      log.qdd.row(k) += second.row(sample);
    }
    keep_bristles(model_.robot(), logs_[l].log, log);
    out.push_back(std::move(log));
  }
  return out;
}

EncoderPilots::Run EncoderPilots::rows_of(const std::vector<PreparedLog>& motion,
                                          const std::vector<std::size_t>& which) const {
  Run run;
  run.rows.resize(which.size());
  for (std::size_t l = 0; l < logs_.size(); ++l) {
    run.Y.push_back(base_rows(model_.robot(), base_, motion[l]));
    if (which.empty()) continue;
    const EffectSignals signals = model_.signals(motion[l], p_, false, &logs_[l].signals);
    for (std::size_t k = 0; k < which.size(); ++k) {
      run.rows[k].push_back(hypothesis_rows(model_, logs_[l], signals, hypotheses_[which[k]]));
    }
  }
  return run;
}

EncoderPilots::Run EncoderPilots::draw(std::uint64_t seed) const {
  Run run = rows_of(motion(seed), sensitive_);
  for (std::size_t l = 0; l < logs_.size(); ++l) {
    for (std::size_t j = 0; j < run.Y[l].size(); ++j) {
      run.Y[l][j] -= still_.Y[l][j];
      for (std::size_t k = 0; k < run.rows.size(); ++k) {
        if (run.rows[k][l][j].size() > 0) run.rows[k][l][j] -= still_.rows[k][l][j];
      }
    }
  }
  return run;
}

EncoderPilots::EncoderPilots(const EffectModel& model, const BaseParameters& base, const std::vector<LogRows>& logs,
                             const VectorXd& p, const WhiteProblem& problem, const std::vector<Hypothesis>& hypotheses,
                             const std::vector<Signature>& signatures, const PerLogAndDrive<double>& position_noise,
                             double cutoff_hz, double low_pass_hz, const DiagnosisOptions& options)
    : model_(model),
      base_(base),
      p_(p),
      hypotheses_(hypotheses),
      position_noise_(position_noise),
      cutoff_hz_(cutoff_hz),
      noisy_column_(options.policy.noisy_column) {
  std::vector<PreparedLog> own;
  for (const LogRows& log : logs) {
    logs_.push_back(thinned(log, low_pass_hz));
    logs_.back().signals = model.signals(logs_.back().log, p, false);
    own.push_back(logs_.back().log);
  }
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    // Columns of pose alone: a few encoder counts do nothing there.
    if (hypotheses[h].kind().effect_class != EffectClass::pose_force) sensitive_.push_back(h);
  }
  still_ = rows_of(own, sensitive_);
  const auto draws = [&](int count, std::uint64_t from) {
    std::vector<Run> runs(static_cast<std::size_t>(count));
    in_parallel(
        count, [&](int k) { runs[static_cast<std::size_t>(k)] = draw(from + static_cast<std::uint64_t>(k)); },
        options.threads);
    return runs;
  };
  // Which scores feel the change of their own columns, beside the torque noise of unit size?
  std::vector<char> feels(hypotheses.size(), 0);
  const VectorXd y = clean(problem);
  for (const Run& run : draws(kTrialRuns, options.seed * 1000003U)) {
    VectorXd r;
    const std::vector<VectorXd> inner = products(problem, run, y, r);
    for (std::size_t k = 0; k < sensitive_.size(); ++k) {
      const std::size_t h = sensitive_[k];
      const Index amplitudes = hypotheses[h].amplitudes;
      for (Index c = 0; c < inner[k].size(); ++c) {
        const MatrixXd& gram = signatures[h].gram[static_cast<std::size_t>(c / amplitudes)];
        if (std::abs(inner[k](c)) > kSensitive * std::sqrt(std::max(gram(c % amplitudes, c % amplitudes), 1e-300)))
          feels[h] = 1;
      }
    }
  }
  std::vector<std::size_t> kept;
  Run still;
  still.Y = std::move(still_.Y);
  for (std::size_t k = 0; k < sensitive_.size(); ++k) {
    if (!feels[sensitive_[k]]) continue;
    kept.push_back(sensitive_[k]);
    still.rows.push_back(std::move(still_.rows[k]));
  }
  sensitive_ = kept;
  still_ = std::move(still);
  runs_ = draws(kPilotRuns, options.seed * 7727U);
}

VectorXd EncoderPilots::clean(const WhiteProblem& problem) const {
  const Index b = base_.count();
  return problem.X.leftCols(b) * problem.beta.head(b);
}

std::vector<VectorXd> EncoderPilots::products(const WhiteProblem& problem, const Run& run, const VectorXd& y,
                                              VectorXd& r) const {
  const Index b = base_.count();
  MatrixXd X = problem.X;
  for (const WhiteSegment& segment : problem.segments) {
    X.block(segment.offset, 0, segment.rows(), b) += segment.whitener.apply(run.Y[segment.log][segment.drive]);
  }
  const VectorXd scale = X.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  X = X * scale.asDiagonal();
  MatrixXd information = X.transpose() * X;
  information.diagonal().array() += 1e-12;
  r = y - X * dense::solve_symmetric(information, VectorXd(X.transpose() * y));
  std::vector<VectorXd> out;
  for (const auto& rows : run.rows) {
    VectorXd inner;
    for (const WhiteSegment& segment : problem.segments) {
      const MatrixXd& raw = rows[segment.log][segment.drive];
      if (raw.size() == 0) continue;
      // r holds nothing of what is unknown.
      const VectorXd part = segment.whitener.innovations(raw).transpose() * r.segment(segment.offset, segment.rows());
      inner = inner.size() == 0 ? part : VectorXd(inner + part);
    }
    out.push_back(inner);
  }
  return out;
}

std::vector<VectorXd> EncoderPilots::bias(const WhiteProblem& problem, const std::vector<Signature>& signatures) const {
  std::vector<VectorXd> out(hypotheses_.size());
  const VectorXd y = clean(problem);
  std::vector<std::vector<VectorXd>> whole(runs_.size());
  in_parallel(runs_.size(), [&](std::size_t run) {
    VectorXd r;
    const std::vector<VectorXd> inner = products(problem, runs_[run], y, r);
    const VectorXd Q_r = problem.Q.transpose() * r;
    whole[run].resize(sensitive_.size());
    for (std::size_t k = 0; k < sensitive_.size(); ++k) {
      const WhiteColumns& white = signatures[sensitive_[k]].white;
      if (white.cols() == 0) continue;
      whole[run][k] = problem.inner(white, r, Q_r) + white.base.transpose() * Q_r;
      if (inner[k].size() > 0) whole[run][k] += inner[k];
    }
  });
  for (const auto& run : whole) {
    for (std::size_t k = 0; k < sensitive_.size(); ++k) {
      VectorXd& sum = out[sensitive_[k]];
      if (run[k].size() == 0) continue;
      if (sum.size() == 0) sum = VectorXd::Zero(run[k].size());
      sum += run[k] / static_cast<double>(runs_.size());
    }
  }
  return out;
}

void EncoderPilots::correct(const WhiteProblem& problem, std::vector<Signature>& signatures) const {
  in_parallel(sensitive_.size(), [&](std::size_t k) {
    const std::size_t h = sensitive_[k];
    Signature& signature = signatures[h];
    if (signature.white.cols() == 0) return;
    const Index amplitudes = hypotheses_[h].amplitudes;
    std::vector<MatrixXd> noise(signature.gram.size(), MatrixXd::Zero(amplitudes, amplitudes));
    const std::size_t runs = std::min(kGramRuns, runs_.size());
    for (std::size_t run = 0; run < runs; ++run) {
      const WhiteColumns change = problem.whiten(runs_[run].rows[k]);
      if (change.cols() < signature.white.cols()) continue;
      for (std::size_t s = 0; s < noise.size(); ++s) {
        noise[s] += change.gram(static_cast<Index>(s) * amplitudes, amplitudes) / static_cast<double>(runs);
      }
    }
    for (std::size_t s = 0; s < noise.size(); ++s) {
      const double share = noise[s].trace() / std::max(signature.gram[s].trace(), 1e-300);
      signature.clean[s] = std::max(kLeastClean, 1 - share);
      // A column that is mostly encoder noise says nothing about the effect.
      if (share > noisy_column_) signature.kept[s] = 0;
    }
  });
}

VectorXd freed_of_bias(const VectorXd& inner, const VectorXd& bias) {
  if (bias.size() == 0 || inner.size() == 0) return inner;
  const VectorXd rest = inner - bias;
  return (rest.array().abs() - kBiasDoubt * bias.array().abs()).max(0.0) * rest.array().sign();
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

}  // namespace deltadyn
