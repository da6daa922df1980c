#include "null_study.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <random>

#include "deltadyn/identification/non_negative_least_squares.hpp"
#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/in_parallel.hpp"
#include "deltadyn/runtime/random.hpp"
#include "deltadyn/signal/butterworth.hpp"
#include "deltadyn/signal/differentiate.hpp"

namespace deltadyn {

namespace {

constexpr double kClear = 3.5;         // standard deviations
constexpr double kTailShare = 0.25;    // of the runs that the tail is fitted to
constexpr int kTrialRuns = 3;          // to tell which columns encoder noise moves
constexpr int kPilotRuns = 12;         // to average what it fakes
constexpr double kSensitive = 0.01;    // change of a column, as a share of its size, that counts
constexpr double kLeastTorque = 0.05;  // share of the spectrum that is the torque's own at least
constexpr Index kSpectrumLags = 24;
constexpr double kBiasDoubt = 0.3;  // share of a faked score that the noise's variance may be wrong by
// Of a Gram matrix that is left at least when the noise's own squares are taken off
constexpr double kLeastClean = 0.6;
constexpr double kMostNoise = 0.75;  // share of a column's squares
constexpr std::size_t kGramRuns = 4;

/// A bristle does not turn with the sign of a noisy rate: the share of Coulomb's friction is given the sign that was
/// taken out of it.
void keep_bristles(const Robot& robot, const PreparedLog& before, PreparedLog& log) {
  if (log.coulomb_share.size() == 0) return;
  const Eigen::Array<bool, 1, Eigen::Dynamic> bristle = (log.coulomb_share.array() != 1.0).colwise().any();
  VectorXd own(robot.friction_joints()), noisy = own;
  for (Index k = 0; k < log.q.rows(); ++k) {
    if (robot.friction_joint_rates(before.q.row(k).transpose(), before.qd.row(k).transpose(), own) != Status::ok ||
        robot.friction_joint_rates(log.q.row(k).transpose(), log.qd.row(k).transpose(), noisy) != Status::ok)
      continue;
    for (Index joint = 0; joint < own.size(); ++joint) {
      if (bristle(joint) && own(joint) * noisy(joint) < 0) log.coulomb_share(k, joint) *= -1;
    }
  }
}

double rarity(double p) {
  return -std::log(std::max(p, 1e-300));
}

/// \param scores  one a distribution
double smallest_p(const std::vector<NullDistribution>& each, const VectorXd& scores) {
  double least = 1;
  for (std::size_t k = 0; k < each.size(); ++k) least = std::min(least, each[k].p_value(scores(static_cast<Index>(k))));
  return least;
}

/// Distributions of the columns of scores, and that of the rarest score of each run.
NullDistribution family_of(const MatrixXd& scores, std::vector<NullDistribution>& each) {
  for (const auto& column : scores.colwise()) each.emplace_back(std::vector<double>(column.begin(), column.end()));
  std::vector<double> rarest;
  for (const auto& run : scores.rowwise()) rarest.push_back(rarity(smallest_p(each, run.transpose())));
  return NullDistribution(std::move(rarest));
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
  return std::min(1.0, family.p_value(rarity(hypothesis[index].p_value(score))));
}

double NullStudy::omnibus_p(const VectorXd& gains) const {
  return std::min(1.0, omnibus_family.p_value(rarity(smallest_p(omnibus, gains))));
}

Omnibus::Omnibus(const WhiteProblem& problem, const GenericBasis& basis) : coordinate_(basis.coordinate) {
  const std::size_t n = basis.coordinate.size();
  for (std::size_t j = 0; j < n; ++j) {
    PerLogAndDrive<MatrixXd> columns(basis.columns.size(), std::vector<MatrixXd>(n));
    for (std::size_t l = 0; l < basis.columns.size(); ++l) columns[l][j] = basis.columns[l][j];
    white_.push_back(problem.whiten(columns));
    MatrixXd G = white_.back().gram(0, white_.back().cols());
    const VectorXd raw = white_.back().raw_gram(0, white_.back().cols()).diagonal().cwiseMax(1e-300);
    const VectorXd scale = raw.cwiseSqrt().cwiseInverse();
    G = scale.asDiagonal() * G * scale.asDiagonal();
    const dense::Spectrum spectrum = dense::spectrum(G);
    const VectorXd& values = spectrum.values;
    std::vector<Index> kept;
    for (Index k = 0; k < values.size(); ++k) {
      if (values(k) > 1e-4 * values.maxCoeff()) kept.push_back(k);
    }
    MatrixXd root(values.size(), static_cast<Index>(kept.size()));
    for (std::size_t k = 0; k < kept.size(); ++k) {
      root.col(static_cast<Index>(k)) = scale.asDiagonal() * spectrum.vectors.col(kept[k]) / std::sqrt(values(kept[k]));
    }
    root_.push_back(root);
  }
}

VectorXd Omnibus::gains(const WhiteProblem& problem, const VectorXd& r, const VectorXd& Q_r) const {
  VectorXd out(static_cast<Index>(white_.size()));
  for (std::size_t j = 0; j < white_.size(); ++j)
    out(static_cast<Index>(j)) = (root_[j].transpose() * problem.inner(white_[j], r, Q_r)).squaredNorm();
  return out;
}

VectorXd Omnibus::clear_part(const WhiteProblem& problem, std::size_t drive) const {
  // Of unit variance if there is nothing but noise.
  VectorXd t = root_[drive].transpose() * problem.inner(white_[drive]);
  t = (t.array().abs() > kClear).select(t, 0.0);
  return root_[drive] * t;
}

std::vector<std::pair<std::string, double>> Omnibus::by_coordinate(const WhiteProblem& problem,
                                                                   std::size_t drive) const {
  std::vector<std::pair<std::string, double>> out;
  const auto& names = coordinate_[drive];
  for (std::size_t first = 0; first < names.size();) {
    std::size_t end = first;
    while (end < names.size() && names[end] == names[first]) ++end;
    const auto count = static_cast<Index>(end - first);
    const WhiteColumns white = white_[drive].part(static_cast<Index>(first), count);
    const std::vector<bool> positive(end - first, false);
    const double gain = non_negative_least_squares(white.clear_gram(0, count), problem.inner(white), positive).gain;
    // What chance alone gives each column is taken off.
    out.emplace_back(names[first], std::max(0.0, gain - static_cast<double>(count)));
    first = end;
  }
  return out;
}

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
                             double cutoff_hz, double low_pass_hz, std::uint64_t seed, int threads)
    : model_(model),
      base_(base),
      p_(p),
      hypotheses_(hypotheses),
      position_noise_(position_noise),
      cutoff_hz_(cutoff_hz) {
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
        count, [&](int k) { runs[static_cast<std::size_t>(k)] = draw(from + static_cast<std::uint64_t>(k)); }, threads);
    return runs;
  };
  // Which scores feel the change of their own columns, beside the torque noise of unit size?
  std::vector<char> feels(hypotheses.size(), 0);
  const VectorXd y = clean(problem);
  for (const Run& run : draws(kTrialRuns, seed * 1000003U)) {
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
  runs_ = draws(kPilotRuns, seed * 7727U);
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
      if (share > kMostNoise) signature.kept[s] = 0;
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

NullStudy run_null_study(const EncoderPilots& pilots, const WhiteProblem& problem,
                         const std::vector<Hypothesis>& hypotheses, const std::vector<Signature>& signatures,
                         const std::vector<VectorXd>& bias, const Omnibus& omnibus, const DiagnosisOptions& options,
                         const std::function<void(double)>& progress) {
  NullStudy out;
  const VectorXd clean = pilots.clean(problem);
  const std::vector<VectorXd> taps = pilots.torque_noise(problem, out.encoder_share);
  MatrixXd scores = MatrixXd::Zero(options.null_runs, static_cast<Index>(hypotheses.size()));
  MatrixXd generic = MatrixXd::Zero(options.null_runs, omnibus.drives());
  int done = 0;
  std::mutex counting;
  const auto run = [&](int k) {
    const std::uint64_t seed = options.seed * 104729U + 15485863U * static_cast<std::uint64_t>(k + 1);
    std::mt19937_64 random(seed);
    NormalDistribution normal;
    VectorXd y = clean;
    for (std::size_t s = 0; s < problem.segments.size(); ++s) {
      const Index rows = problem.segments[s].rows();
      VectorXd white(rows + taps[s].size() - 1);
      for (double& w : white) w = normal(random);
      VectorXd noise(rows);
      for (Index row = 0; row < rows; ++row) noise(row) = taps[s].dot(white.segment(row, taps[s].size()));
      y.segment(problem.segments[s].offset, rows) += problem.segments[s].whitener.known_part(noise);
    }
    VectorXd r;
    const std::vector<VectorXd> sensitive = pilots.products(problem, pilots.draw(seed + 1), y, r);
    const VectorXd Q_r = problem.Q.transpose() * r;
    std::vector<VectorXd> inner(hypotheses.size());
    std::vector<const VectorXd*> changed(hypotheses.size(), nullptr);
    for (std::size_t c = 0; c < sensitive.size(); ++c) changed[pilots.sensitive()[c]] = &sensitive[c];
    for (std::size_t h = 0; h < hypotheses.size(); ++h) {
      if (signatures[h].white.cols() == 0) continue;
      inner[h] = problem.inner(signatures[h].white, r, Q_r);
      if (changed[h] != nullptr) {
        // The column itself, not only its part beside the base model, moves with the regressor.
        inner[h] += signatures[h].white.base.transpose() * Q_r;
        if (changed[h]->size() > 0) inner[h] += *changed[h];
      }
      inner[h] = freed_of_bias(inner[h], bias[h]);
      scores(k, static_cast<Index>(h)) = best_score(hypotheses[h], signatures[h], inner[h]).gain;
    }
    generic.row(k) = omnibus.gains(problem, r, Q_r).transpose();
    const std::lock_guard<std::mutex> lock(counting);
    progress(static_cast<double>(++done) / options.null_runs);
  };
  in_parallel(options.null_runs, run, options.threads);

  out.family = family_of(scores, out.hypothesis);
  out.omnibus_family = family_of(generic, out.omnibus);
  return out;
}

}  // namespace deltadyn
