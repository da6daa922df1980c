#include "deltadyn/identification/identify.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <utility>

#include "deltadyn/identification/prediction.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/plausibility.hpp"
#include "deltadyn/runtime/statistics.hpp"

#include "encoder_uncertainty.hpp"
#include "least_squares.hpp"
#include "noise_bias.hpp"
#include "ripple_search.hpp"
#include "seconds_since.hpp"

namespace deltadyn {

namespace {

using Eigen::Index;
using Clock = std::chrono::steady_clock;

constexpr double kReversalRatio = 3.0;     // above it, rows near reversals follow another law than the model's
constexpr double kChanceSigmas = 3.0;      // of that ratio, where the rest is noise alone
constexpr Index kRowsPerParameter = 10;    // of a drive, to tell noise from what the model lacks
constexpr Index kFewestReversalRows = 10;  // to judge them by
constexpr double kHuber = 1.345;           // 95 % efficient for normal noise (Huber 1981)
// Of the best known parameter's standard deviation: a smaller bias is no matter
constexpr double kFeltNoise = 0.1;

/// Which drives keep their rows near reversals.
std::vector<bool> keep_reversals(const BaseParameters& base, const DataFold& fold, Reversals choice,
                                 std::vector<DriveReport>& drives) {
  std::vector<bool> keep(drives.size(), choice == Reversals::keep);
  if (choice == Reversals::keep) return keep;
  const bool automatic = choice == Reversals::automatic;
  for (std::size_t j = 0; j < keep.size(); ++j) keep[j] = automatic && fold.regular[j].rows < kFewestReversalRows;
  const BaseEstimate estimate = estimate_base_parameters(base, automatic ? fold.to_begin_with() : fold.regular);
  const Eigen::VectorXd p = any_parameters(base, estimate.value, fold.regular.front().R.cols());
  for (std::size_t j = 0; j < drives.size(); ++j) {
    if (fold.reversal[j].rows < kFewestReversalRows || fold.regular[j].rows < kFewestReversalRows) continue;
    drives[j].reversal_ratio = fold.reversal[j].rms(p) / std::max(fold.regular[j].rms(p), 1e-12);
    keep[j] = keep[j] || (automatic && drives[j].reversal_ratio < kReversalRatio);
  }
  return keep;
}

bool averages_periods(const std::vector<PreparedLog>& logs) {
  return std::any_of(logs.begin(), logs.end(), [](const PreparedLog& log) { return log.period_s.has_value(); });
}

/// Least DriveNoise::correlation in units of that of white noise. What a fine encoder adds to the accelerations
/// alternates, so that little of it is left in slow sums; the steps of a coarse one follow the motion about its turning
/// points.
double least_correlation(const Eigen::Ref<const Eigen::VectorXd>& q, double noise_std) {
  // Of the usual rate: quantisation is white above (Widrow, Kollar 2008, chapter 4)
  constexpr double kCountsPerSample = 3;
  constexpr double kFine = 0.05, kCoarse = 0.25;
  const double step = std::sqrt(12.0) * noise_std;
  const Eigen::VectorXd moved = q.tail(q.size() - 1) - q.head(q.size() - 1);
  const double usual = root_mean_square(moved);
  return usual > kCountsPerSample * step ? kFine : kCoarse;
}

/// Bands of the positions' filters.
struct MotionHz {
  double least = 0;       ///< whatever the cut-off of the rows: what the filter bends of the motion is beyond it
  double most = 0;        ///< the same: beyond there is nothing but noise
  double instrument = 0;  ///< nearly all of the motion, and little noise

  /// No wider than little more than the instruments' band.
  [[nodiscard]] MotionHz narrow() const {
    constexpr double kLittleMore = 1.3;
    const double at_most = std::min(most, kLittleMore * instrument);
    return {std::min(least, at_most), at_most, instrument};
  }
};

MotionHz motion_bands(const std::vector<Log>& logs, const Identification& found) {
  constexpr double kUnbent = 4;  // of the band of the motion: there a filter of eighth order takes 1e-5 off
  constexpr double kNearlyAll = 1.5;
  const ProcessingOptions& processing = found.processing;
  try {
    const CutoffChoice motion = found.cutoff ? *found.cutoff : choose_cutoff(logs);
    const double own = processing.motion_over_pass * motion.cutoff_hz;
    return {std::min(kUnbent * motion.band_hz, own), std::max(own, processing.motion_over_pass * motion.noise_limit_hz),
            std::clamp(kNearlyAll * motion.band_hz, std::min(motion.lowest_hz, motion.cutoff_hz), motion.cutoff_hz)};
  } catch (const Error&) {  // the cut-off was given, and the logs are too short to tell
    const double own = processing.motion_over_pass * processing.cutoff_hz;
    return {own, own, processing.cutoff_hz};
  }
}

/// The rows of one fit.
struct Rows {
  std::vector<PreparedLog> prepared;
  DataFold fold;
  std::vector<bool> keep;  ///< one a drive: rows near reversals count

  [[nodiscard]] std::vector<DriveFold> used() const { return fold.with_reversals(keep); }
};

/// One identification at work.
class Identifier {
 public:
  Identifier(const Robot& robot, const std::vector<Log>& logs, const IdentificationOptions& options)
      : robot_(robot), logs_(logs), options_(options) {}

  Identification run(const Eigen::VectorXd& prior, const Eigen::VectorXd& prior_std) {
    const auto start = Clock::now();
    out_.drives.resize(static_cast<std::size_t>(robot_.drives()));
    out_.processing = options_.processing;
    out_.base = find_base_parameters(robot_, options_.base);
    choose_bands();
    const auto fold_start = Clock::now();
    make_rows();
    report(0.4);
    if (options_.processing.filter && options_.reversals == Reversals::automatic) {
      find_everyday_friction();
      leave_out_worse_than_noise();
    }
    for (const PreparedLog& log : rows_.prepared)
      out_.notes.insert(out_.notes.end(), log.notes.begin(), log.notes.end());
    out_.fold_time_s = seconds_since(fold_start);
    report(0.9);
    out_.samples = rows_.fold.samples;
    out_.keep_reversals = rows_.keep;
    estimate_base();
    fit(prior, prior_std);
    tell_drives();
    out_.total_time_s = seconds_since(start);
    return std::move(out_);
  }

 private:
  void report(double share) const {
    if (options_.progress) options_.progress(share);
  }

  void choose_bands() {
    if (!options_.processing.filter) return;
    if (options_.choose_cutoff) {
      ModelCutoff chosen = choose_model_cutoff(robot_, out_.base, logs_, out_.processing, options_.threads);
      out_.processing.cutoff_hz = chosen.cutoff_hz;
      out_.cutoff = std::move(chosen.motion);
      out_.model_band = std::move(chosen.model);
    }
    motion_ = motion_bands(logs_, out_);
    ProcessingOptions usual = filtered(motion_);
    // The steps of coarse encoders lie about the reversals, where they bend friction, and no instrument sees them
    // there: a narrower filter of the positions takes them out, where the motion has nothing beyond it.
    if (has_coarse_encoders(logs_)) {
      ProcessingOptions smooth = filtered(motion_.narrow());
      if (unexplained(smooth) < unexplained(usual)) {
        motion_ = motion_.narrow();
        usual = std::move(smooth);
      }
    }
    out_.processing = std::move(usual);
  }

  [[nodiscard]] ProcessingOptions filtered(const MotionHz& motion) const {
    ProcessingOptions out = out_.processing;
    out.keep_motion(motion.least);
    out.motion_over_pass = std::min(out.motion_over_pass, motion.most / out.cutoff_hz);
    return out;
  }

  /// Mean logarithm of the drives' residuals with the base parameters that fit best; infinite if the logs are too
  /// short.
  [[nodiscard]] double unexplained(const ProcessingOptions& processing) const {
    try {
      const std::vector<DriveFold> folds =
          fold_logs(robot_, prepare_logs(robot_, logs_, processing), options_.threads).to_begin_with();
      const BaseEstimate estimate = estimate_base_parameters(out_.base, folds);
      const Eigen::VectorXd p = any_parameters(out_.base, estimate.value, robot_.parameters());
      double sum = 0;
      for (const DriveFold& drive : folds) sum += std::log(std::max(drive.rms(p), 1e-300));
      return sum / static_cast<double>(folds.size());
    } catch (const Error&) {
      return std::numeric_limits<double>::infinity();
    }
  }

  void make_rows() {
    rows_.prepared = prepare_logs(robot_, logs_, out_.processing);
    rows_.fold = fold_logs(robot_, rows_.prepared, options_.threads);
    rows_.keep = keep_reversals(out_.base, rows_.fold, options_.reversals, out_.drives);
  }

  /// Bristles and ripples become part of the model where the logs show them.
  void find_everyday_friction() {
    if (add_presliding()) make_rows();
    if (options_.find_ripples) add_ripples();
    if (out_.processing.ripples.empty()) return;
    // Once more each with the other one known.
    add_presliding();
    add_ripples();
    make_rows();
  }

  /// True if there is any presliding.
  bool add_presliding() {
    out_.presliding = find_presliding(robot_, out_.base, logs_, out_.processing, options_.threads);
    out_.processing.presliding = displacements(out_.presliding);
    out_.processing.presliding_damping_s = bristle_dampings(out_.presliding);
    return (out_.processing.presliding.array() > 0).any();
  }

  void add_ripples() { out_.processing.ripples = find_ripples(robot_, out_.base, logs_, out_.processing); }

  /// Rows near reversals are kept for what they know beside a model that is off a little everywhere. Where it is exact,
  /// a residual there that is above the noise is none: steps of Coulomb's friction at the wrong moment bend the
  /// parameters by many of their standard deviations.
  void leave_out_worse_than_noise() {
    const std::vector<bool> kept = rows_.keep;
    const auto few = kRowsPerParameter * out_.base.count();
    for (std::size_t j = 0; j < kept.size(); ++j) rows_.keep[j] = kept[j] && rows_.fold.regular[j].rows < few;
    if (rows_.keep == kept) return;
    try {
      out_.base_estimate = estimate_base_parameters(out_.base, rows_.used());
      const std::vector<double> memory = correlations();
      for (std::size_t j = 0; j < kept.size(); ++j) {
        const auto rows = static_cast<double>(rows_.fold.reversal[j].rows);
        const double by_chance = 1 + kChanceSigmas * std::sqrt(memory[j] / (2 * rows));
        // Memory of what is left away from reversals is of what the model lacks.
        const double most = by_chance * std::max(1.0, memory[j] / white_memory());
        if (kept[j] && out_.drives[j].reversal_ratio <= most) rows_.keep[j] = true;
      }
    } catch (const Error&) {  // without them the motion does not show every parameter
      rows_.keep = kept;
    }
  }

  /// DriveNoise::correlation of white noise under the rows' low pass.
  [[nodiscard]] double white_memory() const {
    const auto& low_pass = rows_.prepared.front().low_pass;
    return low_pass ? low_pass->white_correlation() : 1.0;
  }

  [[nodiscard]] Eigen::VectorXd any() const {
    return any_parameters(out_.base, out_.base_estimate.value, robot_.parameters());
  }

  /// Base parameters, their covariance, and what the consistent fit takes from them.
  void estimate_base() {
    std::vector<DriveFold> folds = rows_.used();
    out_.base_estimate = estimate_base_parameters(out_.base, folds);
    if (options_.robust) {
      folds = reweighted();
    } else if (options_.processing.filter && !averages_periods(rows_.prepared)) {
      out_.noise_share = acceleration_noise_share();
      // By about this share noise pulls an inertia down.
      const double best_known = (out_.base_estimate.std().array() / out_.base_estimate.value.array().abs()).minCoeff();
      if (out_.noise_share > kFeltNoise * best_known) {
        bias_ = noise_bias(robot_, out_.base, logs_, out_.processing, rows_.keep, instrument_hz(best_known));
        out_.base_estimate = estimate_base_parameters(out_.base, folds, {}, &*bias_);
      }
    }
    const std::vector<double> correlation = correlations();
    out_.base_estimate = estimate_base_parameters(out_.base, folds, correlation, bias_ ? &*bias_ : nullptr);
    if (!options_.robust && options_.processing.filter && !averages_periods(rows_.prepared))
      add_encoder_steps(correlation);
  }

  /// Band of the instruments in which their own noise is not felt, as its share falls with the fifth power of the band;
  /// not so narrow that they lose the motion.
  [[nodiscard]] double instrument_hz(double best_known) const {
    constexpr double kNarrowest = 0.4;
    const double full_hz = out_.processing.motion_over_pass * out_.processing.cutoff_hz;
    const double quiet_hz = full_hz * std::pow(kFeltNoise * best_known / out_.noise_share, 0.2);
    return std::clamp(quiet_hz, kNarrowest * motion_.instrument, motion_.instrument);
  }

  /// DriveNoise::correlation of each drive: mean over the logs, weighted by their rows.
  [[nodiscard]] std::vector<double> correlations() const {
    const Eigen::VectorXd p = any();
    std::vector<double> sum(rows_.keep.size(), 0.0), rows(sum.size(), 0.0);
    for (std::size_t l = 0; l < logs_.size(); ++l) {
      const PreparedLog& log = rows_.prepared[l];
      const Eigen::VectorXd position_noise = position_noise_std(logs_[l]);
      const Prediction prediction = predict(robot_, log, p, options_.threads);
      const double white = log.low_pass ? log.low_pass->white_correlation() : 1.0;
      for (std::size_t j = 0; j < sum.size(); ++j) {
        const auto drive = static_cast<int>(j);
        const auto usable = prediction.usable(drive, rows_.keep[j]);
        const auto count = static_cast<double>(usable.count());
        const Eigen::VectorXd residual = prediction.residual().col(drive);
        const double least = white * least_correlation(logs_[l].q.col(drive), position_noise(drive));
        sum[j] += count * std::max(least, residual_memory(residual, usable, log.row_rate_hz(), white));
        rows[j] += count;
      }
    }
    for (std::size_t j = 0; j < sum.size(); ++j) sum[j] = rows[j] > 0 ? sum[j] / rows[j] : 1.0;
    return sum;
  }

  /// Standard deviation of each drive's residual from its median size, which outliers hardly move.
  [[nodiscard]] std::vector<double> robust_scales(const Eigen::VectorXd& p) const {
    std::vector<std::vector<double>> sizes(rows_.keep.size());
    for (const PreparedLog& log : rows_.prepared) {
      const Prediction prediction = predict(robot_, log, p, options_.threads);
      const Eigen::MatrixXd size = prediction.residual().cwiseAbs();
      for (std::size_t j = 0; j < sizes.size(); ++j) {
        const auto drive = static_cast<int>(j);
        const auto usable = prediction.usable(drive, rows_.keep[j]);
        for (Index k = 0; k < usable.size(); ++k) {
          if (usable(k)) sizes[j].push_back(size(k, drive));
        }
      }
    }
    std::vector<double> scales;
    for (std::vector<double>& size : sizes)
      scales.push_back(std::max(kMedianToSigma * upper_median(std::move(size)), 1e-12));
    return scales;
  }

  /// Largest share, over logs and drives, of the power of the accelerations that is encoder noise. White up to the
  /// positions' cut-off f, of density D, encoder noise has the power (2 pi)^4 D f^5 / 5 in the acceleration.
  [[nodiscard]] double acceleration_noise_share() const {
    const double f = out_.processing.motion_over_pass * out_.processing.cutoff_hz;
    double share = 0;
    for (std::size_t l = 0; l < logs_.size(); ++l) {
      const PreparedLog& log = rows_.prepared[l];
      const Eigen::VectorXd std = position_noise_std(logs_[l]);
      for (Index j = 0; j < std.size(); ++j) {
        const double density = 2 * std(j) * std(j) / log.rate_hz;
        const double noise = std::pow(2 * std::numbers::pi, 4) * density * std::pow(f, 5) / 5;
        const double power = log.qdd.col(j).squaredNorm() / static_cast<double>(log.qdd.rows());
        if (power > 0) share = std::max(share, noise / power);
      }
    }
    return share;
  }

  /// Huber's weights, a few passes of them.
  std::vector<DriveFold> reweighted() {
    std::vector<DriveFold> folds;
    for (int pass = 0; pass < 5; ++pass) {
      const Eigen::VectorXd p = any();
      const std::vector<double> scale = robust_scales(p);
      const RowWeight weight = [&scale](int drive, double residual) {
        const double limit = kHuber * scale[static_cast<std::size_t>(drive)];
        return std::abs(residual) <= limit ? 1.0 : limit / std::abs(residual);
      };
      folds = fold_logs(robot_, rows_.prepared, options_.threads, &p, weight).with_reversals(rows_.keep);
      out_.base_estimate = estimate_base_parameters(out_.base, folds);
    }
    return folds;
  }

  /// The steps of coarse encoders widen the intervals.
  void add_encoder_steps(const std::vector<double>& correlation) {
    const auto estimate = [&](const std::vector<Log>& logs) -> Eigen::VectorXd {
      const std::vector<DriveFold> folds =
          fold_logs(robot_, prepare_logs(robot_, logs, out_.processing), options_.threads).with_reversals(rows_.keep);
      std::optional<NoiseBias> bias;
      if (bias_) bias = noise_bias(robot_, out_.base, logs, out_.processing, rows_.keep, motion_.instrument);
      return estimate_base_parameters(out_.base, folds, correlation, bias ? &*bias : nullptr).value;
    };
    const Eigen::MatrixXd more = encoder_covariance(logs_, motion_.instrument, estimate);
    if (more.size() > 0) add_uncertainty(out_.base, more, out_.base_estimate);
  }

  /// Name of a body that no part of this robot can be; empty if there is none.
  [[nodiscard]] std::string implausible_body(const Eigen::VectorXd& p) const {
    for (Eigen::Index k = 0; k < p.size(); ++k) {
      const ParameterId& id = robot_.parameter_ids()[static_cast<std::size_t>(k)];
      if (id.kind != ParameterKind::inertial || id.entry != 0) continue;
      try {
        plausibility::require_body(robot_.description(), id.body, p.segment<kInertialParameters>(k), owner_name(id),
                                   "");
      } catch (const Error&) {
        return owner_name(id);
      }
    }
    return "";
  }

  void fit(const Eigen::VectorXd& prior, const Eigen::VectorXd& prior_std) {
    ConsistentFitProblem problem;
    problem.parameters = robot_.parameter_ids();
    problem.A = out_.base_estimate.A;
    problem.b = out_.base_estimate.b;
    problem.prior = prior;
    problem.prior_std = prior_std;
    out_.fit = fit_consistent_parameters(problem, options_.fit);
    if (!options_.fit.regularization) raise_lambda(problem);
    out_.base_from_fit = out_.base.B * out_.fit.p;
  }

  /// The largest lambda that costs the data nothing may be so small that a mass which no motion shows wanders beyond
  /// what a part can weigh, or that an effect which the model has not takes all weight from a part. Such a file is
  /// refused by the next tool, and rightly. A large lambda ends at the prior.
  void raise_lambda(const ConsistentFitProblem& problem) {
    constexpr double kLargestLambda = 1e9;
    const std::string odd = implausible_body(out_.fit.p);
    if (odd.empty()) return;
    ConsistentFitOptions options = options_.fit;
    for (double lambda = 10 * out_.fit.lambda; lambda <= kLargestLambda; lambda *= 10) {
      options.regularization = lambda;
      ConsistentFitSummary raised = fit_consistent_parameters(problem, options);
      if (!raised.converged || !implausible_body(raised.p).empty()) continue;
      raised.notes.push_back(fmt::format(
          "lambda was raised from {:.3g} to {:.3g}: with the smaller one the mass or the moments of {} were "
          "none that such a part can have",
          out_.fit.lambda, lambda, odd));
      // What the data said of it stays: the curve, and the least chi^2.
      raised.lambda_from_data = true;
      raised.l_curve = std::move(out_.fit.l_curve);
      raised.data_cost_min = out_.fit.data_cost_min;
      out_.fit = std::move(raised);
      return;
    }
    out_.fit.notes.push_back(
        fmt::format("no weight of the prior makes {} a part that such a robot can have: look at its prior", odd));
  }

  /// Residuals are told over all rows with their full weight.
  void tell_drives() {
    const std::vector<DriveFold> folds = rows_.used();
    const Eigen::VectorXd p = any();
    for (std::size_t j = 0; j < out_.drives.size(); ++j) {
      const DriveFold& fold = folds[j];
      DriveReport& drive = out_.drives[j];
      drive.rows = fold.rows;
      drive.masked_rows = rows_.keep[j] ? 0 : rows_.fold.reversal[j].rows;
      drive.rms_base = fold.rms(p);
      drive.rms = fold.rms(out_.fit.p);
      drive.rms_torque = std::sqrt(fold.tau_square / std::max<double>(1.0, static_cast<double>(fold.rows)));
      drive.noise = out_.base_estimate.noise[j];
    }
  }

  const Robot& robot_;
  const std::vector<Log>& logs_;
  const IdentificationOptions& options_;
  MotionHz motion_;
  Rows rows_;
  std::optional<NoiseBias> bias_;  ///< of the rows; empty if encoder noise is not felt
  Identification out_;
};

}  // namespace

Identification identify(const Robot& robot, const std::vector<Log>& logs, const Eigen::VectorXd& prior,
                        const Eigen::VectorXd& prior_std, const IdentificationOptions& options) {
  if (logs.empty()) throw Error("there is no log", "", "give at least one log file", ExitCode::usage);
  return Identifier(robot, logs, options).run(prior, prior_std);
}

}  // namespace deltadyn
