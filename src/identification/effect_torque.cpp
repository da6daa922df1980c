#include "deltadyn/identification/effect_torque.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "deltadyn/identification/model_band.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/statistics.hpp"

namespace deltadyn {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// The motion of a log at every sample, not averaged over periods: effects with a memory need the motion as it was.
PreparedLog motion_of(const Robot& robot, const Log& log, ProcessingOptions options) {
  options.periods = Periods::ignore;
  return prepare_log(robot, log, options);
}

bool needs_errors(const std::vector<Effect>& effects) {
  return std::any_of(effects.begin(), effects.end(),
                     [](const Effect& e) { return e.id == EffectId::base_tilt || e.id == EffectId::kinematic_offset; });
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
  options.cutoff_hz = cutoff_hz;
  options.motion_over_pass = 1;
  int number = 0;
  for (Log& log : out) {
    const PreparedLog motion = motion_of(robot, log, options);
    log.tau -= effect_torque(model, model.signals(motion, p, needs_errors(effects)), effects, ++number);
  }
  return out;
}

std::vector<Effect> estimate_amplitudes(const Robot& robot, const std::vector<Log>& logs, const VectorXd& p,
                                        const std::vector<Effect>& effects, const Identification& used) {
  const EffectModel model(robot);
  const BaseParameters base = find_base_parameters(robot);
  const Index b = base.count(), e = amplitude_count(effects), n = robot.drives();
  VectorXd fixed = VectorXd::Zero(e);  // 1: stays as it is
  Index at = 0;
  for (const Effect& effect : effects) {
    const auto count = static_cast<Index>(effect_kind(effect.id).amplitudes.size());
    if (effect_kind(effect.id).tied) fixed.segment(at, count).setOnes();
    at += count;
  }
  const VectorXd start = amplitudes_of(effects);
  std::vector<MatrixXd> X(static_cast<std::size_t>(n));
  std::vector<VectorXd> y(static_cast<std::size_t>(n));
  int number = 0;
  for (const Log& log : logs) {
    const PreparedLog prepared = motion_of(robot, log, used.processing);
    RowBlock block;
    read_rows(robot, prepared, 0, prepared.rows, block);
    const std::vector<MatrixXd> extra = effect_rows(model, prepared, p, effects, ++number);
    for (Index j = 0; j < n; ++j) {
      const auto drive = static_cast<std::size_t>(j);
      const auto counts = [&](Index k) {
        return block.use(k, j) == RowUse::regular || (block.use(k, j) == RowUse::reversal && used.keep_reversals[drive]);
      };
      Index count = 0;
      for (Index k = 0; k < prepared.rows; ++k) count += counts(k) ? 1 : 0;
      const Index first = X[drive].rows();
      X[drive].conservativeResize(first + count, b + e);
      y[drive].conservativeResize(first + count);
      Index row = first;
      for (Index k = 0; k < prepared.rows; ++k) {
        if (!counts(k)) continue;
        for (Index c = 0; c < b; ++c) X[drive](row, c) = block.Y[drive](k, base.independent[static_cast<std::size_t>(c)]);
        X[drive].row(row).tail(e) = extra[drive].row(k).cwiseProduct((1 - fixed.array()).matrix().transpose());
        y[drive](row) = block.tau(k, j) - extra[drive].row(k).dot(fixed.cwiseProduct(start));
        ++row;
      }
    }
  }
  VectorXd weight = VectorXd::Ones(n), solution = VectorXd::Zero(b + e);
  MatrixXd covariance = MatrixXd::Zero(b + e, b + e);
  for (int pass = 0; pass < 4; ++pass) {
    MatrixXd information = MatrixXd::Zero(b + e, b + e);
    VectorXd right = VectorXd::Zero(b + e);
    for (Index j = 0; j < n; ++j) {
      const auto drive = static_cast<std::size_t>(j);
      information += weight(j) * weight(j) * X[drive].transpose() * X[drive];
      right += weight(j) * weight(j) * X[drive].transpose() * y[drive];
    }
    const VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
    const Eigen::CompleteOrthogonalDecomposition<MatrixXd> solver(scaled);
    solution = scale.asDiagonal() * solver.solve(VectorXd(scale.asDiagonal() * right));
    covariance = scale.asDiagonal() * solver.pseudoInverse() * scale.asDiagonal();
    for (Index j = 0; j < n; ++j) {
      const auto drive = static_cast<std::size_t>(j);
      const double rms = root_mean_square(y[drive] - X[drive] * solution);
      weight(j) = 1.0 / std::max(rms, 1e-9 * std::max(y[drive].cwiseAbs().maxCoeff(), 1e-9));
    }
  }
  std::vector<Effect> out = effects;
  VectorXd amplitude = solution.tail(e), std = covariance.diagonal().tail(e).cwiseMax(0.0).cwiseSqrt();
  at = 0;
  for (const Effect& effect : effects) {
    const auto count = static_cast<Index>(effect_kind(effect.id).amplitudes.size());
    for (Index c = 0; c < count; ++c) {
      if (fixed(at + c) == 0) continue;
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
    throw Error("effects need the filtered motion", "", "leave out --no-filter or --effects", ExitCode::usage);
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
  Identification result = identify(robot, without_effects(robot, logs, prior, effects, cutoff_hz), prior, prior_std, settled);
  for (int pass = 0; pass < 2; ++pass) {
    effects = estimate_amplitudes(robot, logs, result.fit.p, effects, result);
    result = identify(robot, without_effects(robot, logs, result.fit.p, effects, cutoff_hz), prior, prior_std, settled);
  }
  // What a residual is a share of is the torque of the drives, with that of the effects.
  const Validation whole = validate_with_effects(robot, logs, effects, result.fit.p, result.processing, options.threads);
  for (std::size_t j = 0; j < result.drives.size(); ++j) result.drives[j].rms_torque = whole.drives[j].rms_torque;
  return result;
}

Validation validate_with_effects(const Robot& robot, const std::vector<Log>& logs, const std::vector<Effect>& effects,
                                 const VectorXd& p, const ProcessingOptions& processing, int threads) {
  const std::vector<Log> rest = without_effects(robot, logs, p, effects, processing.motion_over_pass * processing.cutoff_hz);
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
