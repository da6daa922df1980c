#include "prepare_rows.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "deltadyn/identification/model_band.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/statistics.hpp"

#include "generic_basis.hpp"
#include "noise_estimate.hpp"
#include "whitener.hpp"

namespace deltadyn::detail {

namespace {

constexpr double kMotionOverPass = 2.0;  // cut-off of the motion in units of the one that identification uses: then the
constexpr double kPassOverCutoff = 1.2;  // low pass of regressor and torque, not that of the motion, bounds the band
constexpr double kSharp_hz = 20;         // keeps reversals short, as in choose_cutoff()
constexpr double kUsualNoise = 0.01;     // of a drive's torque
constexpr Index kFewestRows = 10;        // near reversals, to judge a bristle by

bool has_bristle(const ProcessingOptions& processing, Index joint) {
  return joint < processing.presliding.size() && processing.presliding(joint) > 0;
}

/// Options of the rows. Every log is used as it is, and rest is what leave_rest_out() says, but for joints with
/// bristles.
ProcessingOptions row_processing(const RowRules& rules, const std::vector<Log>& logs, double cutoff_hz) {
  ProcessingOptions out = rules.wanted;
  double rate_hz = 1e12;
  for (const Log& log : logs) rate_hz = std::min(rate_hz, 1.0 / log.sample_time_s());
  out.periods = Periods::ignore;
  if (!(out.presliding.array() > 0).any()) out.reversal_floor = std::max(out.reversal_floor, rules.policy.rest_share);
  const double pass_hz = std::min(kPassOverCutoff * cutoff_hz, 0.4 * rate_hz);
  out.cutoff_hz = std::min(kMotionOverPass * cutoff_hz, 0.35 * rate_hz);
  out.motion_over_pass = 1;
  out.torque_cutoff_ratio = pass_hz / out.cutoff_hz;
  // An even stride lets simulated motions be thinned.
  const int stride = std::max(1, static_cast<int>(0.4 * rate_hz / pass_hz));
  out.stride = stride >= 4 ? stride - stride % 4 : (stride >= 2 ? 2 : 1);
  return out;
}

/// Takes a row off either end, so that a thinned motion has a sample to spare.
PreparedLog prepared(const Robot& robot, const Log& log, const ProcessingOptions& options) {
  PreparedLog out = prepare_log(robot, log, options);
  if (out.rest.size() > 0 && out.coulomb_share.size() > 0) out.reversal = out.reversal || out.rest;
  out.rest.resize(0, 0);
  if (out.rows > 10) {
    out.first += out.stride;
    out.rows -= 2;
  }
  return out;
}

/// Rates of the joints that have friction, samples x joints.
MatrixXd friction_rates(const Robot& robot, const PreparedLog& log) {
  MatrixXd rates(log.t_s.size(), robot.friction_joints());
  VectorXd v(robot.friction_joints());
  PathPose path;
  for (Index k = 0; k < rates.rows(); ++k) {
    if (robot.friction_joint_rates(log.q.row(k).transpose(), log.qd.row(k).transpose(), v, &path) != Status::ok)
      v.setZero();
    rates.row(k) = v.transpose();
  }
  return rates;
}

using Marks = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

/// Samples x joints that move so slowly that friction can be that of rest: in slow logs, too, what is slow is measured
/// by the fastest.
std::vector<Marks> slow_samples(const RowRules& rules, const std::vector<PreparedLog>& logs) {
  std::vector<MatrixXd> rates;
  VectorXd largest = VectorXd::Zero(rules.robot.friction_joints());
  for (const PreparedLog& log : logs) {
    rates.push_back(friction_rates(rules.robot, log).cwiseAbs());
    largest = largest.cwiseMax(rates.back().colwise().maxCoeff().transpose());
  }
  std::vector<Marks> out;
  for (const MatrixXd& rate : rates) {
    const VectorXd own = rate.colwise().maxCoeff().transpose();
    Marks slow(rate.rows(), rate.cols());
    for (Index joint = 0; joint < rate.cols(); ++joint)
      slow.col(joint) = rate.col(joint).array() < std::min(rules.policy.rest_share * largest(joint),
                                                           rules.policy.rest_share_of_slow * own(joint));
    out.push_back(std::move(slow));
  }
  return out;
}

/// Leaves out what slow joints do, but for those whose bristles hold.
void leave_rest_out(const Robot& robot, const ProcessingOptions& processing, const std::vector<Marks>& slow,
                    const std::vector<int>& masked, std::vector<PreparedLog>& logs) {
  for (std::size_t l = 0; l < logs.size(); ++l) {
    for (Index joint = 0; joint < slow[l].cols(); ++joint) {
      if (has_bristle(processing, joint) && std::ranges::count(masked, static_cast<int>(joint)) == 0) continue;
      for (int j = 0; j < robot.drives(); ++j) {
        const bool feels = joint < robot.drives() ? j == joint : robot.description().feels_inner_joint(j);
        if (feels) logs[l].reversal.col(j) = logs[l].reversal.col(j) || slow[l].col(joint);
      }
    }
  }
}

/// rms of a drive's residual in rows near its reversals; nothing where there are few of them.
std::optional<double> rms_near_reversals(const std::vector<LogRows>& logs, const std::vector<Marks>& slow,
                                         const BaseParameters& base, const VectorXd& beta, Index drive) {
  const auto j = static_cast<std::size_t>(drive);
  double square = 0;
  Index count = 0;
  for (std::size_t l = 0; l < logs.size(); ++l) {
    const LogRows& log = logs[l];
    const VectorXd e = log.tau.col(drive) - log.Y[j].leftCols(base.count()) * beta;
    const Index reach = log.log.low_pass ? log.log.low_pass->half_width() : 0;
    for (Index row = 0; row < log.rows(); ++row) {
      if (!log.usable[j](row) || !slow[l].col(drive).segment(sample_of_row(log.log, row) - reach, 2 * reach + 1).any())
        continue;
      square += e(row) * e(row);
      ++count;
    }
  }
  if (count < kFewestRows) return std::nullopt;
  return std::sqrt(square / static_cast<double>(count));
}

/// Largest floor over the logs, beside a basis that follows whatever the motion explains.
VectorXd floors(const std::vector<LogRows>& logs) {
  const PerLogAndDrive<double> floor = estimate_noise(logs, make_generic_basis(logs), {}).floor_rms;
  VectorXd out = VectorXd::Zero(static_cast<Index>(floor.front().size()));
  for (const auto& log : floor) {
    for (std::size_t j = 0; j < log.size(); ++j)
      out(static_cast<Index>(j)) = std::max(out(static_cast<Index>(j)), log[j]);
  }
  return out;
}

}  // namespace

SearchCutoff search_cutoff(const RowRules& rules, const std::vector<Log>& logs, int threads) {
  const ModelCutoff model = choose_model_cutoff(rules.robot, rules.base, logs, rules.wanted, threads);
  SearchCutoff out;
  out.chosen_hz = std::min(model.cutoff_hz, rules.policy.widest_cutoff_hz);
  out.widest_hz = std::max(out.chosen_hz, std::min(kSharp_hz, model.motion.noise_limit_hz));
  out.sharp_hz = std::max(out.widest_hz, kSharp_hz);
  return out;
}

DiagnosisRows prepare_rows(const RowRules& rules, const std::vector<Log>& logs, const Log* holdout, double cutoff_hz,
                           const std::vector<int>& masked) {
  const Robot& robot = rules.robot;
  std::vector<Log> all = logs;
  if (holdout != nullptr) all.push_back(*holdout);
  DiagnosisRows out;
  out.processing = row_processing(rules, all, cutoff_hz);
  std::vector<PreparedLog> ready;
  for (const Log& log : all) ready.push_back(prepared(robot, log, out.processing));
  leave_rest_out(robot, out.processing, slow_samples(rules, ready), masked, ready);
  for (std::size_t l = 0; l < logs.size(); ++l)
    out.logs.push_back(make_log_rows(robot, rules.base, std::move(ready[l]), static_cast<int>(l) + 1));
  if (holdout != nullptr) out.held.push_back(make_log_rows(robot, rules.base, std::move(ready.back()), 0));
  return out;
}

std::vector<int> drives_without_hold(const RowRules& rules, const EffectModel& model, const std::vector<Log>& logs,
                                     double cutoff_hz, const VectorXd& p) {
  const Robot& robot = rules.robot;
  const BaseParameters& base = rules.base;
  std::vector<int> with;
  for (int j = 0; j < robot.drives(); ++j) {
    if (has_bristle(rules.wanted, j)) with.push_back(j);
  }
  if (with.empty()) return with;
  DiagnosisRows masked = prepare_rows(rules, logs, nullptr, cutoff_hz, with);
  for (LogRows& log : masked.logs) log.signals = model.signals(log.log, p, false);
  const DiagnosisRows whole = prepare_rows(rules, logs, nullptr, cutoff_hz, {});
  std::vector<PreparedLog> motion;
  for (const LogRows& log : whole.logs) motion.push_back(log.log);
  const std::vector<Marks> slow = slow_samples(rules, motion);
  const VectorXd beta = base.B * refit_parameters(base, whole.logs, p), floor = floors(masked.logs);
  std::erase_if(with, [&](int j) {
    const std::optional<double> near = rms_near_reversals(whole.logs, slow, base, beta, j);
    return near && *near < rules.policy.bristle_holds * floor(j);
  });
  return with;
}

KnownRows fewest_rows(const std::vector<LogRows>& logs) {
  KnownRows fewest{1e12, 1};
  for (std::size_t j = 0; j < logs.front().usable.size(); ++j) {
    double known = 0, all = 0;
    for (const LogRows& log : logs) {
      const auto tau = log.tau.col(static_cast<Index>(j));
      const NoiseModel noise{{}, std::max(kUsualNoise * root_mean_square(tau), 1e-12)};
      known += static_cast<double>(Whitener(noise, log.present[j], log.unknown[j]).freedom());
      all += static_cast<double>(log.rows());
    }
    if (known < fewest.count) fewest = {known, known / std::max(all, 1.0)};
  }
  return fewest;
}

}  // namespace deltadyn::detail
