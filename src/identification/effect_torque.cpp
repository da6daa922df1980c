#include "deltadyn/identification/effect_torque.hpp"

#include <algorithm>
#include <limits>

#include "deltadyn/identification/model_band.hpp"
#include "deltadyn/identification/non_negative_least_squares.hpp"
#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/statistics.hpp"

namespace deltadyn {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kRounding = std::numeric_limits<double>::epsilon();  // of a direction of the columns, for each of them

/// The motion of a log at every sample, not averaged over periods: effects with a memory need the motion as it was.
PreparedLog motion_of(const Robot& robot, const Log& log, ProcessingOptions options) {
  options.periods = Periods::ignore;
  return prepare_log(robot, log, options);
}

/// Rows of base parameters and amplitudes, drive by drive.
struct AmplitudeRows {
  std::vector<MatrixXd> X;     ///< for each drive rows x (base + amplitudes)
  std::vector<VectorXd> y;     ///< for each drive the torque without what is fixed
  VectorXd fixed;              ///< for each amplitude: 1 stays as it is
  std::vector<bool> positive;  ///< for each column
};

AmplitudeRows amplitude_rows(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs,
                             const VectorXd& p, const std::vector<Effect>& effects, const Identification& used) {
  const EffectModel model(robot);
  const Index b = base.count(), e = amplitude_count(effects), n = robot.drives();
  AmplitudeRows out;
  out.X.resize(static_cast<std::size_t>(n));
  out.y.resize(static_cast<std::size_t>(n));
  out.fixed.resize(e);
  out.positive.assign(static_cast<std::size_t>(b), false);
  Index at = 0;
  for (const Effect& effect : effects) {
    for (const AmplitudeTraits& amplitude : effect_kind(effect.id).amplitudes) {
      out.fixed(at++) = effect_kind(effect.id).tied ? 1 : 0;
      out.positive.push_back(amplitude.positive());
    }
  }
  const VectorXd start = amplitudes_of(effects);
  int number = 0;
  for (const Log& log : logs) {
    const PreparedLog prepared = motion_of(robot, log, used.processing);
    RowBlock block;
    read_rows(robot, prepared, 0, prepared.rows, block);
    const std::vector<MatrixXd> extra = effect_rows(model, prepared, p, effects, ++number);
    for (Index j = 0; j < n; ++j) {
      const auto drive = static_cast<std::size_t>(j);
      MatrixXd& X = out.X[drive];
      VectorXd& y = out.y[drive];
      const auto counts = usable_rows(block.use, j, used.keep_reversals[drive]);
      Index row = X.rows();
      X.conservativeResize(row + counts.count(), b + e);
      y.conservativeResize(row + counts.count());
      for (Index k = 0; k < prepared.rows; ++k) {
        if (!counts(k)) continue;
        X.row(row).head(b) = block.Y[drive].row(k)(base.independent);
        X.row(row).tail(e) = extra[drive].row(k).cwiseProduct((1 - out.fixed.array()).matrix().transpose());
        y(row) = block.tau(k, j) - extra[drive].row(k).dot(out.fixed.cwiseProduct(start));
        ++row;
      }
    }
  }
  return out;
}

/// Variances of the solution over some columns of a Gram matrix of weighted rows; 0 elsewhere.
VectorXd variances_over(const MatrixXd& information, const std::vector<bool>& columns) {
  const VectorXd taken = VectorXd::NullaryExpr(
      information.rows(), [&](Index c) { return columns[static_cast<std::size_t>(c)] ? 1.0 : 0.0; });
  const VectorXd scale = taken.cwiseProduct(information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse());
  const MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const MatrixXd inverse = dense::pseudo_inverse(scaled);
  return (scale.asDiagonal() * inverse * scale.asDiagonal()).diagonal().cwiseMax(0.0);
}

/// Variance of each column. A column at its bound has that of the fit without bounds.
VectorXd variances(const MatrixXd& information, const std::vector<bool>& free) {
  const VectorXd all = variances_over(information, std::vector<bool>(free.size(), true)),
                 inside = variances_over(information, free);
  return VectorXd::NullaryExpr(all.size(),
                               [&](Index c) { return free[static_cast<std::size_t>(c)] ? inside(c) : all(c); });
}

}  // namespace

MatrixXd effect_torque(const EffectModel& model, const EffectSignals& signals, const std::vector<Effect>& effects,
                       int log_number) {
  MatrixXd torque = MatrixXd::Zero(signals.q.rows(), signals.q.cols());
  for (const Effect& effect : effects) {
    const auto columns = model.columns(signals, effect.id, effect.joint, effect.shape, log_number);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double amplitude = effect.amplitude(static_cast<Index>(c));
      if (columns[c].drive < 0) {
        torque += amplitude * columns[c].values;
      } else {
        torque.col(columns[c].drive) += amplitude * columns[c].values;
      }
    }
  }
  return torque;
}

std::vector<Log> without_effects(const Robot& robot, const std::vector<Log>& logs, const VectorXd& p,
                                 const std::vector<Effect>& effects, double cutoff_hz) {
  if (effects.empty()) return logs;
  const EffectModel model(robot);
  std::vector<Log> out = logs;
  ProcessingOptions options;
  options.filter = cutoff_hz > 0;
  options.cutoff_hz = options.filter ? cutoff_hz : options.cutoff_hz;
  options.motion_over_pass = 1;
  int number = 0;
  for (Log& log : out) {
    const PreparedLog motion = motion_of(robot, log, options);
    const std::vector<Effect> here = effects_in_log(effects, log.file, ++number);
    log.tau -= effect_torque(model, model.signals(motion, p, needs_differences(effects)), here, number);
  }
  return out;
}

std::vector<Effect> estimate_amplitudes(const Robot& robot, const std::vector<Log>& logs, const VectorXd& p,
                                        const std::vector<Effect>& effects, const Identification& used) {
  const BaseParameters base = find_base_parameters(robot);
  const AmplitudeRows rows = amplitude_rows(robot, base, logs, p, effects, used);
  const Index columns = base.count() + amplitude_count(effects), e = amplitude_count(effects);
  VectorXd weight = VectorXd::Ones(robot.drives());
  NonNegativeSolution fit;
  MatrixXd information;
  for (int pass = 0; pass < 4; ++pass) {
    information = MatrixXd::Zero(columns, columns);
    VectorXd right = VectorXd::Zero(columns);
    for (std::size_t drive = 0; drive < rows.X.size(); ++drive) {
      const double w = weight(static_cast<Index>(drive));
      information += w * w * rows.X[drive].transpose() * rows.X[drive];
      right += w * w * rows.X[drive].transpose() * rows.y[drive];
    }
    fit = non_negative_least_squares(information, right, rows.positive, kRounding * static_cast<double>(columns));
    for (std::size_t drive = 0; drive < rows.X.size(); ++drive) {
      const VectorXd& y = rows.y[drive];
      const double rms = root_mean_square(y - rows.X[drive] * fit.x);
      weight(static_cast<Index>(drive)) = 1.0 / std::max(rms, 1e-9 * std::max(y.cwiseAbs().maxCoeff(), 1e-9));
    }
  }
  std::vector<Effect> out = effects;
  VectorXd amplitude = fit.x.tail(e), std = variances(information, fit.free).tail(e).cwiseSqrt();
  Index at = 0;
  for (const Effect& effect : effects) {
    const auto count = static_cast<Index>(effect_kind(effect.id).amplitudes.size());
    for (Index c = 0; c < count; ++c) {
      if (rows.fixed(at + c) == 0) continue;
      amplitude(at + c) = effect.amplitude(c);
      std(at + c) = effect.amplitude_std.size() == count ? effect.amplitude_std(c) : 0.0;
    }
    at += count;
  }
  set_amplitudes(amplitude, std, out);
  return out;
}

Identification identify_with_effects(const Robot& robot, const std::vector<Log>& logs, const VectorXd& prior,
                                     const VectorXd& prior_std, const IdentificationOptions& options,
                                     std::vector<Effect>& effects) {
  if (effects.empty()) return identify(robot, logs, prior, prior_std, options);
  if (!options.processing.filter) {
    throw Error("effects need the filtered motion", "--effects with --no-filter", "leave out one of the two flags",
                ExitCode::usage);
  }
  IdentificationOptions settled = options;
  if (options.choose_cutoff) {
    settled.processing.cutoff_hz =
        choose_model_cutoff(robot, find_base_parameters(robot, options.base), logs, options.processing, options.threads)
            .cutoff_hz;
    settled.choose_cutoff = false;
  }
  const double cutoff_hz = settled.processing.motion_over_pass * settled.processing.cutoff_hz;
  // With what the file says first, so that the model's torque is known for the effects that follow it.
  Identification result =
      identify(robot, without_effects(robot, logs, prior, effects, cutoff_hz), prior, prior_std, settled);
  for (int pass = 0; pass < 2; ++pass) {
    effects = estimate_amplitudes(robot, logs, result.fit.p, effects, result);
    result = identify(robot, without_effects(robot, logs, result.fit.p, effects, cutoff_hz), prior, prior_std, settled);
  }
  // What a residual is a share of is the torque of the drives, with that of the effects.
  const Validation whole =
      validate_with_effects(robot, logs, effects, result.fit.p, result.processing, options.threads);
  for (std::size_t j = 0; j < result.drives.size(); ++j) result.drives[j].rms_torque = whole.drives[j].rms_torque;
  return result;
}

Validation validate_with_effects(const Robot& robot, const std::vector<Log>& logs, const std::vector<Effect>& effects,
                                 const VectorXd& p, const ProcessingOptions& processing, int threads) {
  const double motion_hz = processing.filter ? processing.motion_over_pass * processing.cutoff_hz : 0;
  const std::vector<Log> rest = without_effects(robot, logs, p, effects, motion_hz);
  Validation out = validate(robot, rest, p, processing, threads);
  if (effects.empty()) return out;
  for (std::size_t l = 0; l < logs.size(); ++l) {
    const PreparedLog whole = prepare_log(robot, logs[l], processing);
    const MatrixXd torque = low_passed_rows(whole, whole.tau - prepare_log(robot, rest[l], processing).tau);
    out.logs[l].prediction.tau += torque;
    out.logs[l].prediction.model += torque;
  }
  const std::vector<ValidatedDrive> figures = drive_figures(out.logs, out.drives.size());
  for (std::size_t j = 0; j < figures.size(); ++j) {
    out.drives[j].rms_torque = figures[j].rms_torque;
    out.drives[j].relative_residual = figures[j].relative_residual;
  }
  return out;
}

}  // namespace deltadyn
