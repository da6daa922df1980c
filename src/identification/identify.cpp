#include "deltadyn/identification/identify.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "deltadyn/identification/noise_bias.hpp"
#include "deltadyn/identification/prediction.hpp"
#include "deltadyn/identification/ripple_search.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {

namespace {

using Eigen::Index;
using Clock = std::chrono::steady_clock;

constexpr double kReversalRatio = 3.0;  // above it, rows near reversals follow another law than the model's
constexpr Index kFewestRows = 10;       // to judge them by
constexpr double kHuber = 1.345;        // 95 % efficient for normal noise (Huber 1981)
constexpr double kFeltNoise = 1e-5;     // share of an acceleration's power that is encoder noise; less moves no figure
constexpr double kNoiseMemory_s = 0.2;  // time over which residual correlation is looked for

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

DataFold fold_all(const Robot& robot, const std::vector<PreparedLog>& logs, int threads, const Eigen::VectorXd* p = nullptr,
                  const RowWeight& weight = {}) {
  DataFold fold;
  for (const PreparedLog& log : logs) fold.add(fold_log(robot, log, threads, p, weight));
  return fold;
}

/// Regular rows that are fewer than those near reversals show little of the motion: reversals are then judged beside a fit of both.
bool needs_reversals(const DriveFold& regular, const DriveFold& reversal) {
  return regular.rows < reversal.rows;
}

/// Which drives keep their rows near reversals.
std::vector<bool> keep_reversals(const BaseParameters& base, const DataFold& fold, Reversals choice,
                                 std::vector<DriveReport>& drives) {
  std::vector<bool> keep(drives.size(), choice == Reversals::keep);
  if (choice == Reversals::keep) return keep;
  std::vector<DriveFold> folds = fold.regular;
  for (std::size_t j = 0; j < folds.size() && choice == Reversals::automatic; ++j) {
    keep[j] = fold.regular[j].rows < kFewestRows;
    if (needs_reversals(fold.regular[j], fold.reversal[j])) folds[j].add(fold.reversal[j]);
  }
  const BaseEstimate estimate = estimate_base_parameters(base, folds);
  const Eigen::VectorXd p = any_parameters(base, estimate.value, fold.regular.front().R.cols());
  for (std::size_t j = 0; j < drives.size(); ++j) {
    if (fold.reversal[j].rows < kFewestRows || fold.regular[j].rows < kFewestRows) continue;
    drives[j].reversal_ratio = fold.reversal[j].rms(p) / std::max(fold.regular[j].rms(p), 1e-12);
    keep[j] = keep[j] || (choice == Reversals::automatic && drives[j].reversal_ratio < kReversalRatio);
  }
  return keep;
}

bool averages_periods(const std::vector<PreparedLog>& logs) {
  return std::any_of(logs.begin(), logs.end(), [](const PreparedLog& log) { return log.period_s.has_value(); });
}

std::vector<DriveFold> select(const DataFold& fold, const std::vector<bool>& keep) {
  std::vector<DriveFold> folds = fold.regular;
  for (std::size_t j = 0; j < folds.size(); ++j) {
    if (keep[j]) folds[j].add(fold.reversal[j]);
  }
  return folds;
}

/// Least DriveNoise::correlation in units of that of white noise. What a fine encoder adds to the accelerations alternates, so that
/// little of it is left in slow sums; the steps of a coarse one follow the motion about its turning points.
double least_correlation(const Eigen::Ref<const Eigen::VectorXd>& q, double noise_std) {
  constexpr double kCountsPerSample = 3;  // of the usual rate: quantisation is white above (Widrow, Kollar 2008, chapter 4)
  constexpr double kFine = 0.05, kCoarse = 0.45;
  const double step = std::sqrt(12.0) * noise_std;
  const Eigen::VectorXd moved = q.tail(q.size() - 1) - q.head(q.size() - 1);
  const double usual = std::sqrt(moved.squaredNorm() / static_cast<double>(moved.size()));
  return usual > kCountsPerSample * step ? kFine : kCoarse;
}

/// DriveNoise::correlation of each drive: mean over the logs, weighted by their rows.
std::vector<double> correlations(const Robot& robot, const std::vector<Log>& recorded, const std::vector<PreparedLog>& logs,
                                 const Eigen::VectorXd& p, const std::vector<bool>& keep, int threads) {
  std::vector<double> sum(keep.size(), 0.0), rows(keep.size(), 0.0);
  for (std::size_t l = 0; l < logs.size(); ++l) {
    const PreparedLog& log = logs[l];
    const Eigen::VectorXd position_noise = position_noise_std(recorded[l]);
    const Prediction prediction = predict(robot, log, p, threads);
    const auto lags = static_cast<Index>(std::ceil(kNoiseMemory_s * log.rate_hz / static_cast<double>(log.stride)));
    const double white = log.low_pass ? log.low_pass->white_correlation() : 1.0;
    for (std::size_t j = 0; j < keep.size(); ++j) {
      const auto drive = static_cast<int>(j);
      const auto usable = prediction.usable(drive, keep[j]);
      const auto count = static_cast<double>(usable.count());
      const Eigen::VectorXd residual = prediction.tau.col(drive) - prediction.model.col(drive);
      const double least = white * least_correlation(recorded[l].q.col(drive), position_noise(drive));
      sum[j] += count * std::max(least, noise_correlation(residual, usable, std::min<Index>(lags, 50), white));
      rows[j] += count;
    }
  }
  for (std::size_t j = 0; j < sum.size(); ++j) sum[j] = rows[j] > 0 ? sum[j] / rows[j] : 1.0;
  return sum;
}

/// Standard deviation of each drive's residual from its median size, which outliers hardly move.
std::vector<double> robust_scales(const Robot& robot, const std::vector<PreparedLog>& logs, const Eigen::VectorXd& p,
                                  const std::vector<bool>& keep, int threads) {
  constexpr double kMedianToSigma = 1.4826;  // for normal noise
  std::vector<std::vector<double>> sizes(keep.size());
  for (const PreparedLog& log : logs) {
    const Prediction prediction = predict(robot, log, p, threads);
    for (std::size_t j = 0; j < keep.size(); ++j) {
      const auto drive = static_cast<int>(j);
      const auto usable = prediction.usable(drive, keep[j]);
      for (Index k = 0; k < prediction.rows(); ++k) {
        if (usable(k)) sizes[j].push_back(std::abs(prediction.tau(k, drive) - prediction.model(k, drive)));
      }
    }
  }
  std::vector<double> scales;
  for (std::vector<double>& size : sizes) {
    if (size.empty()) size.push_back(0);
    const auto middle = size.begin() + static_cast<std::ptrdiff_t>(size.size() / 2);
    std::nth_element(size.begin(), middle, size.end());
    scales.push_back(std::max(kMedianToSigma * *middle, 1e-12));
  }
  return scales;
}

/// Largest share, over logs and drives, of the power of the accelerations that is encoder noise: white up to the positions' cut-off f,
/// of density D, it has (2 pi)^4 D f^5 / 5.
double acceleration_noise_share(const std::vector<Log>& logs, const std::vector<PreparedLog>& prepared,
                                const ProcessingOptions& processing) {
  const double f = processing.motion_over_pass * processing.cutoff_hz;
  double share = 0;
  for (std::size_t l = 0; l < logs.size(); ++l) {
    const Eigen::VectorXd std = position_noise_std(logs[l]);
    for (Index j = 0; j < logs[l].drives(); ++j) {
      const double density = 2 * std(j) * std(j) / prepared[l].rate_hz;
      const double noise = std::pow(2 * std::numbers::pi, 4) * density * std::pow(f, 5) / 5;
      const double power = prepared[l].qdd.col(j).squaredNorm() / static_cast<double>(prepared[l].qdd.rows());
      if (power > 0) share = std::max(share, noise / power);
    }
  }
  return share;
}

/// Band of the motion; the cut-off where it was given and the logs are too short to tell.
double motion_hz(const std::vector<Log>& logs, const Identification& found) {
  if (found.cutoff) return found.processing.cutoff_hz;  // the motion that the model explains
  try {
    return choose_cutoff(logs).cutoff_hz;
  } catch (const Error&) {
    return found.processing.cutoff_hz;
  }
}

std::vector<PreparedLog> prepare_all(const Robot& robot, const std::vector<Log>& logs, const ProcessingOptions& options) {
  std::vector<PreparedLog> prepared;
  prepared.reserve(logs.size());
  for (const Log& log : logs) prepared.push_back(prepare_log(robot, log, options));
  return prepared;
}

/// Looks for presliding. True if there is any.
bool add_presliding(const Robot& robot, const std::vector<Log>& logs, int threads, Identification& out) {
  out.presliding = find_presliding(robot, out.base, logs, out.processing, threads);
  out.processing.presliding = displacements(out.presliding);
  out.processing.presliding_damping_s = bristle_dampings(out.presliding);
  return (out.processing.presliding.array() > 0).any();
}

}  // namespace

Identification identify(const Robot& robot, const std::vector<Log>& logs, const Eigen::VectorXd& prior,
                        const Eigen::VectorXd& prior_std, const IdentificationOptions& options) {
  if (logs.empty()) throw Error("there is no log", "", "give at least one log file", ExitCode::usage);
  const auto start = Clock::now();
  const auto report = [&](double share) {
    if (options.progress) options.progress(share);
  };
  Identification out;
  out.drives.resize(static_cast<std::size_t>(robot.drives()));
  out.processing = options.processing;
  out.base = find_base_parameters(robot, options.base);
  if (options.processing.filter && options.choose_cutoff) {
    ModelCutoff chosen = choose_model_cutoff(robot, out.base, logs, out.processing, options.threads);
    out.processing.cutoff_hz = chosen.cutoff_hz;
    out.cutoff = std::move(chosen.motion);
    out.model_band = std::move(chosen.model);
  }

  const double band_hz = options.processing.filter ? motion_hz(logs, out) : 0.0;
  if (options.processing.filter) out.processing.keep_motion(band_hz);
  // Noise is kept out by the motion's own band, even where the model explains less of it.
  const double instrument_hz = out.cutoff ? out.cutoff->cutoff_hz : band_hz;

  const auto fold_start = Clock::now();
  std::vector<PreparedLog> prepared = prepare_all(robot, logs, out.processing);
  DataFold fold = fold_all(robot, prepared, options.threads);
  std::vector<bool> keep = keep_reversals(out.base, fold, options.reversals, out.drives);
  report(0.4);
  const auto prepare_again = [&]() {
    prepared = prepare_all(robot, logs, out.processing);
    fold = fold_all(robot, prepared, options.threads);
    keep = keep_reversals(out.base, fold, options.reversals, out.drives);
  };
  if (options.processing.filter && options.reversals == Reversals::automatic) {
    if (add_presliding(robot, logs, options.threads, out)) prepare_again();
    if (options.find_ripples) out.processing.ripples = find_ripples(robot, out.base, logs, out.processing, keep);
    if (!out.processing.ripples.empty()) {
      // Once more each with the other one known.
      add_presliding(robot, logs, options.threads, out);
      out.processing.ripples = find_ripples(robot, out.base, logs, out.processing, keep);
      prepare_again();
    }
  }
  for (const PreparedLog& log : prepared) out.notes.insert(out.notes.end(), log.notes.begin(), log.notes.end());
  out.fold_time_s = seconds_since(fold_start);
  report(0.9);
  out.samples = fold.samples;

  out.keep_reversals = keep;
  std::vector<DriveFold> folds = select(fold, keep);
  const std::vector<DriveFold> as_recorded = folds;
  std::optional<NoiseBias> bias;
  out.base_estimate = estimate_base_parameters(out.base, folds);
  Eigen::VectorXd p = any_parameters(out.base, out.base_estimate.value, robot.parameters());
  if (options.robust) {
    for (int pass = 0; pass < 5; ++pass) {
      const std::vector<double> scale = robust_scales(robot, prepared, p, keep, options.threads);
      const RowWeight weight = [&scale](int drive, double residual) {
        const double limit = kHuber * scale[static_cast<std::size_t>(drive)];
        return std::abs(residual) <= limit ? 1.0 : limit / std::abs(residual);
      };
      folds = select(fold_all(robot, prepared, options.threads, &p, weight), keep);
      out.base_estimate = estimate_base_parameters(out.base, folds);
      p = any_parameters(out.base, out.base_estimate.value, robot.parameters());
    }
  } else if (options.compensate_noise && options.processing.filter && !averages_periods(prepared)) {
    out.noise_share = acceleration_noise_share(logs, prepared, out.processing);
    if (out.noise_share > kFeltNoise) {
      bias = noise_bias(robot, out.base, logs, out.processing, keep, instrument_hz);
      out.base_estimate = estimate_base_parameters(out.base, folds, {}, &*bias);
      p = any_parameters(out.base, out.base_estimate.value, robot.parameters());
    }
  }
  fold.regular = as_recorded;  // the residual is reported over all rows with their full weight
  const std::vector<double> correlation = correlations(robot, logs, prepared, p, keep, options.threads);
  out.base_estimate = estimate_base_parameters(out.base, folds, correlation, bias ? &*bias : nullptr);

  ConsistentFitProblem problem;
  problem.names = robot.parameter_names();
  problem.A = out.base_estimate.A;
  problem.b = out.base_estimate.b;
  problem.prior = prior;
  problem.prior_std = prior_std;
  out.fit = fit_consistent_parameters(problem, options.fit);
  out.base_from_fit = out.base.B * out.fit.p;

  p = any_parameters(out.base, out.base_estimate.value, robot.parameters());
  for (std::size_t j = 0; j < out.drives.size(); ++j) {
    DriveReport& drive = out.drives[j];
    drive.rows = fold.regular[j].rows;
    drive.masked_rows = keep[j] ? 0 : fold.reversal[j].rows;
    drive.rms_base = fold.regular[j].rms(p);
    drive.rms = fold.regular[j].rms(out.fit.p);
    drive.rms_torque = std::sqrt(fold.regular[j].tau_square / std::max<double>(1.0, static_cast<double>(drive.rows)));
    drive.noise = out.base_estimate.noise[j];
  }
  out.total_time_s = seconds_since(start);
  return out;
}

}  // namespace deltadyn
