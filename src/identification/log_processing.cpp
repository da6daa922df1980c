#include "deltadyn/identification/log_processing.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "deltadyn/core/sign.hpp"
#include "deltadyn/effects/bristle.hpp"
#include "deltadyn/effects/wave.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/signal/differentiate_log.hpp"
#include "deltadyn/signal/fourier.hpp"
#include "deltadyn/signal/reversal_mask.hpp"

namespace deltadyn {

namespace {

using Eigen::Index;

constexpr Index kFewestRows = 20;
constexpr double kReversalSigmas = 4;   // a rate below this many standard deviations of its noise has no certain sign
constexpr double kMostOverPass = 10;    // of the positions' filter, in units of the rows' cut-off
constexpr double kLeastCoverage = 0.9;  // of the log by whole periods; below, averaging throws too much away
constexpr double kMostHarmonics = 300;  // of the Fourier fit, whose time grows with the square
// Slow for longer is no reversal but rest, where static friction takes any value
constexpr double kRest_s = 0.05;
// Displacements after which a bristle has forgotten how the log began (5 % left)
constexpr double kForgotten = 3.0;

std::string place(const PreparedLog& log, Index sample) {
  if (!log.line.empty() && log.line[static_cast<std::size_t>(sample)] > 0) {
    return fmt::format("{}, line {}", log.file, log.line[static_cast<std::size_t>(sample)]);
  }
  return fmt::format("{}, t_s = {:.6g}", log.file, log.t_s(sample));
}

[[noreturn]] void refuse_pose(const PreparedLog& log, Index sample, Status status) {
  const auto q = log.q.row(sample);
  std::string angles;
  for (Index j = 0; j < q.size(); ++j) angles += fmt::format("{}{:.4g}", j > 0 ? ", " : "", q(j));
  throw Error(fmt::format("{} at drive positions ({})", message(status), angles), place(log, sample),
              status == Status::ambiguous
                  ? "keep the motion away from the rim of the workspace, where the plate may snap over"
                  : "check that the robot file belongs to this machine, and zero, sign and unit of the drive "
                    "positions");
}

/// Rates of the joints with friction at every sample: N x friction joints. Refuses poses that the robot cannot have.
Eigen::MatrixXd joint_rates(const Robot& robot, const PreparedLog& log) {
  Eigen::MatrixXd rates(log.t_s.size(), robot.friction_joints());
  Eigen::VectorXd v(robot.friction_joints());
  PathPose path;
  for (Index k = 0; k < log.t_s.size(); ++k) {
    const Status status = robot.friction_joint_rates(log.q.row(k).transpose(), log.qd.row(k).transpose(), v, &path);
    if (status != Status::ok) refuse_pose(log, k, status);
    rates.row(k) = v.transpose();
  }
  return rates;
}

/// Value of a joint in a list that may be shorter.
double value_or_none(const Eigen::VectorXd& of_joints, Index joint) {
  return joint < of_joints.size() ? of_joints(joint) : 0.0;
}

/// The bristles' share of Coulomb's friction along a log, for the joints that have presliding (effects/bristle.hpp).
/// \param rates  N x joints with friction
void add_presliding(const ProcessingOptions& options, const Eigen::MatrixXd& rates, PreparedLog& log) {
  if (!(options.presliding.array() > 0).any()) return;
  log.coulomb_share.setOnes(rates.rows(), rates.cols());
  for (Index j = 0; j < rates.cols(); ++j) {
    const double displacement = value_or_none(options.presliding, j);
    if (!(displacement > 0)) continue;
    const double damping_s = value_or_none(options.presliding_damping_s, j);
    Bristle<double> bristle(displacement, sign_of(rates(0, j)));
    for (Index k = 0; k < rates.rows(); ++k) {
      // The bar has no position of its own in the log: its rate serves, over the step that leads here.
      const double step = k == 0             ? 0.0
                          : j < log.q.cols() ? log.q(k, j) - log.q(k - 1, j)
                                             : 0.5 * (rates(k, j) + rates(k - 1, j)) / log.rate_hz;
      const double state = bristle.move(step), rate = rates(k, j);
      log.coulomb_share(k, j) = damped_bristle(rate, state, displacement, damping_s) * sign_of(rate);
    }
  }
}

void add_ripples(const ProcessingOptions& options, PreparedLog& log) {
  if (options.ripples.empty()) return;
  log.ripple.setZero(log.q.rows(), log.q.cols());
  for (const Ripple& ripple : options.ripples) {
    for (Index k = 0; k < log.q.rows(); ++k) {
      const Wave<double> parts = wave(log.q(k, ripple.drive), ripple.n);
      log.ripple(k, ripple.drive) += ripple.cosine * parts.cosine + ripple.sine * parts.sine;
    }
  }
}

/// Of a mask of slow samples the stretches at rest.
std::vector<char> rest_of(const std::vector<char>& slow, double rate_hz) {
  const auto shortest = static_cast<std::ptrdiff_t>(std::max(2.0, std::round(kRest_s * rate_hz)));
  std::vector<char> rest(slow.size(), 0);
  for (auto begin = slow.begin(); begin != slow.end();) {
    const auto end = std::find_if(begin, slow.end(), [&](char value) { return value != *begin; });
    if (*begin != 0 && end - begin >= shortest)
      std::fill_n(rest.begin() + (begin - slow.begin()), end - begin, char{1});
    begin = end;
  }
  return rest;
}

/// Start of a log until a bristle has forgotten where it stood before.
std::vector<char> unknown_start(const Eigen::Ref<const Eigen::VectorXd>& rate, double displacement, double rate_hz) {
  std::vector<char> unknown(static_cast<std::size_t>(rate.size()), 0);
  double travelled = 0;
  for (Index k = 0; k < rate.size() && travelled < kForgotten * displacement; ++k) {
    travelled += std::abs(rate(k)) / rate_hz;
    unknown[static_cast<std::size_t>(k)] = 1;
  }
  return unknown;
}

/// Marks the samples at which the sign of a friction force in a drive's torque is uncertain: its own, and that of the
/// inner joint in the drives that feel it (a telescope's length does not depend on psi). A joint whose friction builds
/// up over a displacement needs no sign: there only rest is uncertain.
void mark_reversals(const Robot& robot, const ProcessingOptions& options, const Eigen::VectorXd& sigma_qd,
                    PreparedLog& log) {
  const Eigen::MatrixXd rates = joint_rates(robot, log);
  std::vector<std::vector<char>> mask, rest;
  for (Index j = 0; j < rates.cols(); ++j) {
    // The bar's rate has no sensor of its own: the floor serves, its noise being that of the plate.
    const double noise = j < sigma_qd.size() ? kReversalSigmas * sigma_qd(j) : 0.0;
    mask.push_back(
        reversal_mask(rates.col(j), std::max(noise, options.reversal_floor * rates.col(j).cwiseAbs().maxCoeff()), 0));
    rest.push_back(rest_of(mask.back(), log.rate_hz));
    if (const double displacement = value_or_none(options.presliding, j); displacement > 0)
      mask.back() = unknown_start(rates.col(j), displacement, log.rate_hz);
  }
  add_presliding(options, rates, log);
  add_ripples(options, log);
  log.reversal.resize(log.t_s.size(), robot.drives());
  log.rest.resize(log.t_s.size(), robot.drives());
  for (int j = 0; j < robot.drives(); ++j) {
    const bool inner = robot.description().feels_inner_joint(j);
    for (Index k = 0; k < log.t_s.size(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      log.reversal(k, j) = mask[static_cast<std::size_t>(j)][at] != 0 || (inner && mask.back()[at] != 0);
      log.rest(k, j) = rest[static_cast<std::size_t>(j)][at] != 0 || (inner && rest.back()[at] != 0);
    }
  }
}

/// Standard deviation of the drives' filtered rates, from the noise of the positions.
Eigen::VectorXd velocity_noise(const Log& log, double motion_cutoff_hz) {
  Eigen::VectorXd sigma(log.drives());
  for (Index j = 0; j < log.drives(); ++j) {
    sigma(j) = derivative_noise(position_noise(log.q.col(j)), 1.0 / log.sample_time_s(), motion_cutoff_hz, 4, 1);
  }
  return sigma;
}

/// Copies what a log holds. The torque columns are needed from here on.
PreparedLog copy_log(const Robot& robot, const Log& log) {
  if (log.q.cols() != robot.drives() || log.tau.cols() != robot.drives()) {
    throw Error(fmt::format("the log has {} positions and {} torques, the robot {} drives", log.q.cols(),
                            log.tau.cols(), robot.drives()),
                log.file, "use the robot file of the machine that the log was recorded on");
  }
  PreparedLog out;
  static_cast<Log&>(out) = log;
  out.notes.clear();
  out.findings.clear();
  out.rate_hz = 1.0 / log.sample_time_s();
  return out;
}

double motion_cutoff_hz(const ProcessingOptions& options) {
  return options.motion_over_pass * options.cutoff_hz;
}

/// Low pass of regressor and torque.
std::shared_ptr<const FirDecimator> low_pass_of(double rate_hz, const ProcessingOptions& options) {
  const double low_pass_hz = std::min(options.torque_cutoff_ratio * options.cutoff_hz, 0.4 * rate_hz);
  const int factor = options.stride > 0 ? options.stride : std::max(1, static_cast<int>(0.4 * rate_hz / low_pass_hz));
  return std::make_shared<FirDecimator>(rate_hz, low_pass_hz, factor);
}

/// The period to average over, if the log has one and the series stays small.
std::optional<double> period_of(const Log& log, const ProcessingOptions& options, std::vector<std::string>& notes) {
  if (options.periods == Periods::ignore) return std::nullopt;
  double period_s = options.period_s;
  if (options.periods == Periods::detect) {
    const std::optional<Period> found = find_period(log);
    if (!found) return std::nullopt;
    period_s = found->period_s;
    const double length_s = static_cast<double>(log.samples()) * log.sample_time_s();
    if (static_cast<double>(found->whole_periods) * period_s < kLeastCoverage * length_s) return std::nullopt;
  }
  const double per_period = period_s / log.sample_time_s();
  if (period_s * motion_cutoff_hz(options) > kMostHarmonics || std::abs(per_period - std::round(per_period)) > 1e-3) {
    notes.push_back(fmt::format(
        "{}: periods of {:.6g} s are not averaged (a period must be a whole number of samples and shorter than "
        "{:.3g} s at this cut-off)",
        log.file, period_s, kMostHarmonics / motion_cutoff_hz(options)));
    return std::nullopt;
  }
  return period_s;
}

/// One period: Fourier series of the motion up to the cut-off, mean of the torque. Continued on either side by what the
/// low pass needs, so that no edge is lost.
PreparedLog prepare_periodic(const Robot& robot, const Log& log, double period_s, const ProcessingOptions& options) {
  const PeriodMean mean =
      average_periods(log, period_s, std::max(1, static_cast<int>(period_s * motion_cutoff_hz(options))));
  const Index samples = mean.log.samples();
  PreparedLog out = copy_log(robot, mean.log);
  out.line.clear();
  out.low_pass = low_pass_of(out.rate_hz, options);
  out.stride = out.low_pass->factor();
  out.first = out.low_pass->half_width();
  out.rows = samples / out.stride;
  const Index length = samples + 2 * out.first;
  out.t_s =
      Eigen::VectorXd::LinSpaced(length, -static_cast<double>(out.first), static_cast<double>(length - 1 - out.first)) /
      out.rate_hz;
  out.q = mean.series.evaluate(out.t_s);
  out.qd = mean.series.evaluate(out.t_s, 1);
  out.qdd = mean.series.evaluate(out.t_s, 2);
  out.tau.resize(length, log.drives());
  out.filled.assign(static_cast<std::size_t>(length), Log::kMeasured);
  if (mean.log.torque_out.size() > 0) out.torque_out.resize(length, log.drives());
  for (Index k = 0; k < length; ++k) {
    const Index phase = ((k - out.first) % samples + samples) % samples;
    out.tau.row(k) = mean.log.tau.row(phase);
    out.filled[static_cast<std::size_t>(k)] = mean.log.is_left_out(phase) ? Log::kLeftOut : Log::kMeasured;
    if (out.torque_out.size() > 0) out.torque_out.row(k) = mean.log.torque_out.row(phase);
  }
  out.period_s = period_s;
  mark_reversals(robot, options,
                 velocity_noise(log, motion_cutoff_hz(options)) / std::sqrt(static_cast<double>(mean.periods)), out);
  out.notes.push_back(fmt::format("{}: periodic, {} periods of {:.6g} s averaged, {} harmonics", log.file, mean.periods,
                                  period_s, mean.series.harmonics));
  return out;
}

}  // namespace

void ProcessingOptions::keep_motion(double motion_hz) {
  motion_over_pass = std::clamp(motion_hz / cutoff_hz, motion_over_pass, std::max(motion_over_pass, kMostOverPass));
}

void ProcessingOptions::validate() const {
  const auto demand = [](bool fine, const char* field, const char* range) {
    if (fine) return;
    throw Error(std::string("the option is out of range; ") + range, field, "choose a value in the range",
                ExitCode::usage);
  };
  const auto not_negative = [](const Eigen::VectorXd& v) { return (v.array() >= 0).all() && v.allFinite(); };
  demand(cutoff_hz > 0 && std::isfinite(cutoff_hz), "cutoff_hz", "it must be above 0 Hz");
  demand(motion_over_pass >= 0.02 && motion_over_pass <= kMostOverPass, "motion_over_pass", "it must be 0.02 to 10");
  demand(torque_cutoff_ratio > 0 && torque_cutoff_ratio <= 10, "torque_cutoff_ratio",
         "it must be above 0 and at most 10");
  demand(periods != Periods::given || period_s > 0, "period_s", "it must be above 0 s");
  demand(reversal_floor >= 0 && reversal_floor < 1, "reversal_floor", "it must be at least 0 and below 1");
  demand(stride >= 0, "stride", "it must be at least 0");
  demand(not_negative(presliding), "presliding", "displacements must be at least 0");
  demand(not_negative(presliding_damping_s), "presliding_damping_s", "dampings must be at least 0 s");
}

PreparedLog prepare_log(const Robot& robot, const Log& log, const ProcessingOptions& options) {
  options.validate();
  PreparedLog out = copy_log(robot, log);
  const Index samples = log.samples();
  if (!options.filter) {
    if (log.qd.size() == 0 || log.qdd.size() == 0) {
      throw Error("without filtering, the log must hold velocities and accelerations", log.file,
                  "add the columns qd1_rad_s.. and qdd1_rad_s2.., or let the tool filter and differentiate");
    }
    out.stride = std::max(1, options.stride);
    out.rows = (samples + out.stride - 1) / out.stride;
    out.reversal.setConstant(samples, robot.drives(), false);
    add_ripples(options, out);
    (void)joint_rates(robot, out);  // refuses poses out of reach
    return out;
  }
  if (const std::optional<double> period_s = period_of(log, options, out.notes))
    return prepare_periodic(robot, log, *period_s, options);

  DriveMotion motion = differentiate_log(log, motion_cutoff_hz(options));
  out.q = std::move(motion.q);
  out.qd = std::move(motion.qd);
  out.qdd = std::move(motion.qdd);
  out.low_pass = low_pass_of(out.rate_hz, options);
  out.stride = out.low_pass->factor();
  const Index reach = out.low_pass->half_width();
  out.first = std::max(reach, motion.first);
  const Index last = std::min(samples - reach, motion.last);
  out.rows = last > out.first ? (last - out.first + out.stride - 1) / out.stride : 0;
  if (out.rows < kFewestRows) {
    throw Error(fmt::format("the log lasts {:.3g} s, too short for a cut-off of {:.3g} Hz",
                            static_cast<double>(samples) / out.rate_hz, options.cutoff_hz),
                log.file,
                fmt::format("record at least {:.3g} s, or raise the cut-off",
                            static_cast<double>(2 * out.first + kFewestRows * out.stride) / out.rate_hz));
  }
  mark_reversals(robot, options, velocity_noise(log, motion_cutoff_hz(options)), out);
  return out;
}

std::vector<PreparedLog> prepare_logs(const Robot& robot, const std::vector<Log>& logs,
                                      const ProcessingOptions& options) {
  std::vector<PreparedLog> prepared;
  for (const Log& log : logs) prepared.push_back(prepare_log(robot, log, options));
  return prepared;
}

Eigen::Array<bool, Eigen::Dynamic, 1> usable_rows(const RowUses& use, Index drive, bool with_reversals) {
  if (with_reversals) return use.col(drive) != RowUse::unusable;
  return use.col(drive) == RowUse::regular;
}

bool left_out(const PreparedLog& log, int drive, Index first, Index count) {
  return log.any_left_out(first, count) ||
         (log.torque_out.size() > 0 && log.torque_out.col(drive).segment(first, count).any());
}

namespace {

Index reach_of(const PreparedLog& log) {
  return log.low_pass ? log.low_pass->half_width() : 0;
}

/// Regressor and torques of the samples that rows are filtered from.
struct UnfilteredRows {
  Index first_sample = 0, step = 1;
  Eigen::MatrixXd
      values;  ///< Y of drive 1, of drive 2, ..., then the torques, and those of the ripples if there are any

  /// \param reach  samples on either side of a row that its filter needs
  UnfilteredRows(const Robot& robot, const PreparedLog& log, Index first_row, Index count, Index reach)
      : first_sample(sample_of_row(log, first_row) - reach) {
    const int n = robot.drives();
    const Index P = robot.parameters();
    if (!log.low_pass) step = log.stride;  // the filter needs every sample, without it only those of the rows
    const Index last_sample = sample_of_row(log, first_row + count - 1) + reach;
    const std::vector<Index> coulomb = log.coulomb_share.size() > 0 ? coulomb_columns(robot) : std::vector<Index>{};
    values.resize((last_sample - first_sample) / step + 1, n * (P + (log.ripple.size() > 0 ? 2 : 1)));
    Eigen::MatrixXd Y(n, P);
    PathPose path;
    for (Index k = 0; k < values.rows(); ++k) {
      const Index at = first_sample + k * step;
      const Status status =
          robot.regressor(log.q.row(at).transpose(), log.qd.row(at).transpose(), log.qdd.row(at).transpose(), Y, &path);
      if (status != Status::ok) refuse_pose(log, at, status);
      for (std::size_t joint = 0; joint < coulomb.size(); ++joint)
        Y.col(coulomb[joint]) *= log.coulomb_share(at, static_cast<Index>(joint));
      for (int j = 0; j < n; ++j) values.row(k).segment(j * P, P) = Y.row(j);
      values.row(k).segment(n * P, n) = log.tau.row(at);
      if (log.ripple.size() > 0) values.row(k).tail(n) = log.ripple.row(at);
    }
  }

  /// The rows under the low pass of `log`.
  [[nodiscard]] Eigen::MatrixXd rows(const PreparedLog& log, Index first_row, Index count) const {
    const Index from = (sample_of_row(log, first_row) - reach_of(log) - first_sample) / step;
    if (!log.low_pass) return values.middleRows(from, count);
    Eigen::MatrixXd out(count, values.cols());
    log.low_pass->apply(values.middleRows(from, log.low_pass->inputs(count)), out);
    return out;
  }
};

void fill_block(const PreparedLog& log, Index first_row, const Eigen::MatrixXd& rows, int n, RowBlock& block) {
  const Index P = rows.cols() / n - (log.ripple.size() > 0 ? 2 : 1), reach = reach_of(log), count = rows.rows();
  block.first_row = first_row;
  block.Y.resize(static_cast<std::size_t>(n));
  for (int j = 0; j < n; ++j) block.Y[static_cast<std::size_t>(j)] = rows.middleCols(j * P, P);
  block.tau = rows.middleCols(n * P, n);
  block.ripple.resize(0, 0);
  if (log.ripple.size() > 0) {
    block.ripple = rows.rightCols(n);
    block.tau -= block.ripple;
  }
  block.use.setConstant(count, n, RowUse::regular);
  for (Index k = 0; k < count; ++k) {
    const Index from = sample_of_row(log, first_row + k) - reach, length = 2 * reach + 1;
    for (int j = 0; j < n; ++j) {
      if (log.reversal.col(j).segment(from, length).any()) block.use(k, j) = RowUse::reversal;
      if ((log.rest.size() > 0 && log.rest.col(j).segment(from, length).any()) || left_out(log, j, from, length))
        block.use(k, j) = RowUse::unusable;
    }
  }
}

}  // namespace

void read_rows(const Robot& robot, const PreparedLog& log, Index first_row, Index count, RowBlock& block) {
  const UnfilteredRows unfiltered(robot, log, first_row, count, reach_of(log));
  fill_block(log, first_row, unfiltered.rows(log, first_row, count), robot.drives(), block);
}

void read_rows(const Robot& robot, const PreparedLog& log, const PreparedLog& other, Index first_row, Index count,
               RowBlock& block, RowBlock& other_block) {
  const UnfilteredRows unfiltered(robot, log, first_row, count, std::max(reach_of(log), reach_of(other)));
  fill_block(log, first_row, unfiltered.rows(log, first_row, count), robot.drives(), block);
  fill_block(other, first_row, unfiltered.rows(other, first_row, count), robot.drives(), other_block);
}

}  // namespace deltadyn
