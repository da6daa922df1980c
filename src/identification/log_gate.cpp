#include "deltadyn/identification/log_gate.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <optional>
#include <string_view>
#include <tuple>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/identification/model_band.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/signal/torque_timing_mend.hpp"

#include "gate/clock_drift.hpp"
#include "gate/given_derivatives.hpp"
#include "gate/judge.hpp"
#include "gate/mirror.hpp"
#include "gate/outside_torque.hpp"
#include "gate/plausibility.hpp"
#include "gate/torque_offset.hpp"
#include "gate/torque_timing.hpp"

namespace deltadyn {

namespace {

using namespace gate;
using Eigen::Index;

constexpr Index kPoints = 500;        // of all logs, for signs, orders and units
constexpr double kLeastDelay = 0.05;  // of a sample: less is no matter
// Relative residual of a log without other faults. Above it the model lacks something (friction after reversals, load),
// and what it lacks can pass for a delay: then the delay must take half of the residual away.
constexpr double kCleanFit = 0.015;
constexpr double kNoiseOnly = 1.5;  // times what the noise of the torque makes of the residual
constexpr double kHalf = 0.5;
constexpr double kWorthSaying = 0.9;  // of the residual, for a delay that stays
constexpr double kSharp_s = 6e-4;     // a delay known no better is more likely another effect that bends the torque
// Of the residual: delays of single drives and lags must show in it, as noise can feign them
constexpr double kWorthRemoving = 0.98;
constexpr double kLongest_s = 0.025;  // no recorder or drive is later; what looks so is slow friction or a spring
constexpr double kSteady = 3.0;       // standard deviations by which a timing may differ in a lower band
constexpr double kLowestTiming_hz = 4;
constexpr double kOutOfReach = 0.01;  // share of poses
// Relative residual above which estimated masses are not compared with the prior's
constexpr double kMassesMean = 0.15;
constexpr double kUnexplained = 0.25;  // relative residual that no sound log of this robot leaves

/// The gate at work on one set of logs.
class Gate {
 public:
  Gate(const Robot& robot, std::vector<Log> logs, const Eigen::VectorXd& prior, const Eigen::VectorXd& prior_std,
       const GateOptions& options)
      : robot_(robot), prior_(prior), prior_std_(prior_std), options_(options) {
    out_.logs = std::move(logs);
  }

  GateResult run() {
    for (const Log& log : out_.logs) {
      if (log.q.cols() != robot_.drives() || log.tau.cols() != robot_.drives())
        return std::move(out_);  // others refuse it better
      add(examine_derivatives(robot_.description(), log, options_.given_derivatives));
    }
    base_ = find_base_parameters(robot_);
    if (options_.given_derivatives) {
      if (out_.stop()) return std::move(out_);  // rows with wrong rates tell nothing else
      judge_positions(points_as_given());
      if (!out_.stop()) judge_scale(points_as_given());
      return std::move(out_);
    }
    Sample sample = take_sample(out_.logs);
    if (sample.stretches.empty()) return std::move(out_);
    const std::size_t before = out_.findings.size();
    coarse_ = sample.coarse;
    torque_noise_ = relative_torque_noise(out_.logs, sample);
    judge_positions(pick_points(sample, kPoints));
    if (out_.stop()) return std::move(out_);
    if (std::vector<LogFinding> pushed = leave_out_outside_torque(robot_, base_, out_.logs); !pushed.empty()) {
      // What was judged was a pushed machine.
      sample = take_sample(out_.logs);
      out_.findings.resize(before);
      judge_positions(pick_points(sample, kPoints));
      add(std::move(pushed));
      if (out_.stop()) return std::move(out_);
    }
    judge_timing(sample);
    Sample mended = take_sample(out_.logs);
    if (!options_.offsets_known) judge_offset(mended);
    judge_scale(pick_points(mended, kPoints));
    if (!out_.fault() && !coarse_) {
      if (std::optional<LogFinding> mirrored = mirror_finding(robot_, base_, mended))
        out_.findings.push_back(*std::move(mirrored));
    }
    return std::move(out_);
  }

 private:
  void add(std::vector<LogFinding> more) {
    out_.findings.insert(out_.findings.end(), std::make_move_iterator(more.begin()),
                         std::make_move_iterator(more.end()));
  }

  /// Rows of the logs as they are, evenly thinned.
  [[nodiscard]] Points points_as_given() const {
    Points out;
    Index all = 0;
    for (const Log& log : out_.logs) all += log.qd.size() > 0 && log.qdd.size() > 0 ? log.samples() : 0;
    const Index step = std::max<Index>(1, all / (2 * kPoints));
    std::vector<std::pair<const Log*, Index>> rows;
    for (const Log& log : out_.logs) {
      if (log.qd.size() == 0 || log.qdd.size() == 0) continue;
      for (Index k = 0; k < log.samples(); k += step) rows.emplace_back(&log, k);
    }
    const auto N = static_cast<Index>(rows.size());
    for (Eigen::MatrixXd* m : {&out.q, &out.qd, &out.qdd, &out.tau}) m->resize(N, robot_.drives());
    out.torque_out.setConstant(N, robot_.drives(), false);
    for (Index k = 0; k < N; ++k) {
      const auto& [log, row] = rows[static_cast<std::size_t>(k)];
      out.q.row(k) = log->q.row(row);
      out.qd.row(k) = log->qd.row(row);
      out.qdd.row(k) = log->qdd.row(row);
      out.tau.row(k) = log->tau.row(row);
      if (log->torque_out.size() > 0) out.torque_out.row(k) = log->torque_out.row(row);
      out.at.push_back({0, k});
    }
    return out;
  }

  void judge_positions(const Points& points) {
    const Judgement judgement = judge(robot_, base_, points);
    std::vector<LogFinding> limits = limit_findings(robot_.description(), out_.logs, !options_.given_derivatives);
    // Positions far beyond the limits are the same fault seen from another side.
    if (!judgement.winners.empty())
      std::erase_if(limits, [](const LogFinding& l) { return l.key == "position_range" || l.key == "position_rate"; });
    residual_ = judgement.sound ? 0.0 : judgement.as_given.residual;
    if (judgement.winners.empty()) {
      add(std::move(limits));
      add(plate_findings(robot_, out_.logs));
      tell_unexplained(judgement);
      return;
    }
    const Explanation& first = judgement.winners.front();
    LogFinding f{.level = FindingLevel::fault,
                 .key = first.key,
                 .drive = first.drive,
                 .value = judgement.as_given.residual,
                 .text = fmt::format("{}: residual {} as given, {:.2g} % so", first.words, as_given_in_words(judgement),
                                     100 * first.residual),
                 .mend = first.mend};
    if (first.value != 0) std::tie(f.value, f.std) = std::pair(first.value, first.std);
    for (std::size_t k = 1; k < std::min<std::size_t>(3, judgement.winners.size()); ++k) {
      f.text += fmt::format("{}{}", k == 1 ? "; as well explained: " : "; or: ", judgement.winners[k].words);
    }
    if (is_turned_yaw(robot_.description(), first)) {
      f.text += "; as well explained: the limbs are numbered clockwise";
      f.mend +=
          "; or swap the columns of limbs 2 and 3: limb 2 stands 120 deg counter-clockwise from limb 1 seen from above";
    }
    out_.findings.push_back(std::move(f));
    add(std::move(limits));
  }

  static std::string as_given_in_words(const Judgement& judgement) {
    std::string text = fmt::format("{:.2g} %", 100 * judgement.as_given.residual);
    if (judgement.as_given.unreachable > kOutOfReach)
      text += fmt::format(" and {:.2g} % of the poses out of reach", 100 * judgement.as_given.unreachable);
    return text;
  }

  /// No hypothesis of the list explains the log, but it is not that of this robot either.
  void tell_unexplained(const Judgement& judgement) {
    const double unreachable = judgement.as_given.unreachable, residual = judgement.as_given.residual;
    if (unreachable > kOutOfReach) {
      // What reads the rows refuses them with file and line; here is what is known beyond that.
      out_.findings.push_back(
          {.level = FindingLevel::fault,
           .key = "pose",
           .value = unreachable,
           .text =
               fmt::format("{:.3g} % of the poses cannot be reached by this robot, and no sign, order, unit or zero "
                           "of the drives explains it",
                           100 * unreachable),
           .mend = "check that the robot file belongs to this machine: its lengths, and where the drives' zero is"});
    } else if (residual > kUnexplained && judgement.with_springs > kHalf * residual && !coarse_) {
      out_.findings.push_back(
          {.level = residual > kNoiseOnly * torque_noise_ ? FindingLevel::fault : FindingLevel::warning,
           .key = "unexplained",
           .value = residual,
           .text = fmt::format("{:.2g} % of the torque is explained by no parameters of this robot, and by no sign, "
                               "order, unit or zero of the drives",
                               100 * residual),
           .mend = "check that the robot file belongs to this machine, and look at the raw signals"});
    }
  }

  [[nodiscard]] Timing timing_of(const Sample& sample) const {
    const std::vector<int> files = file_numbers(out_.logs);
    std::vector<double> least;
    for (std::size_t l = 0; l < files.size(); ++l) {
      if (files[l] == static_cast<int>(least.size())) least.push_back(kLeastDelay * out_.logs[l].sample_time_s());
    }
    return estimate_timing(sample, low_passed_rows(robot_, base_, sample, Reading::as_given(robot_.drives())), least);
  }

  /// Residual up to which nothing but the noise of the torque record is left.
  static double clean(double noise) { return std::max(kCleanFit, kNoiseOnly * noise); }

  /// The sample in the band in which the model explains the torque, if that ends below the sample's own.
  [[nodiscard]] std::optional<Sample> within_model_band(const Sample& sample) const {
    try {
      const ProcessingOptions processing;
      const ModelCutoff choice = choose_model_cutoff(robot_, base_, out_.logs, processing);
      const double band_hz = processing.torque_cutoff_ratio * choice.model.limit_hz;
      if (choice.model.limit_hz == 0 || band_hz >= sample.band_hz) return std::nullopt;
      Sample narrow = take_sample(out_.logs, SampleOptions::in_band(band_hz));
      if (!narrow.stretches.empty()) return narrow;
    } catch (const Error&) {  // NOLINT(bugprone-empty-catch)
      // Logs too short for a cut-off, or poses out of reach: others say so.
    }
    return std::nullopt;
  }

  /// Sum of delay and lag of each log and drive, and its standard deviation.
  static std::pair<Eigen::MatrixXd, Eigen::MatrixXd> lateness(const Timing& timing) {
    return {timing.shift.delay + timing.shift.lag,
            (timing.std.delay.array().square() + timing.std.lag.array().square()).sqrt()};
  }

  /// Is a timing the same in a lower band, as far as that band tells it?
  static bool holds(const Timing& timing, const Timing& lower) {
    const auto [late, std] = lateness(timing);
    const auto [late_lower, std_lower] = lateness(lower);
    const Eigen::ArrayXXd chance =
        (std_lower.array().square() - std.array().square()).max(0.25 * std.array().square()).sqrt();
    return ((late - late_lower).array().abs() < kSteady * chance).all();
  }

  /// A drive's loop answers the noise of its encoder: that torque is real, while the acceleration beside it is not all
  /// seen, and both together look like a delay. It shrinks with the band much faster than what a band tells of a real
  /// one: the highest band whose timing holds in the next lower one is taken.
  [[nodiscard]] Timing steady_timing(Sample sample) const {
    Timing timing = timing_of(sample);
    while (timing.significant && sample.band_hz > kLowestTiming_hz) {
      Sample lower = take_sample(out_.logs, SampleOptions::in_band(sample.band_hz / std::numbers::sqrt2));
      if (lower.stretches.empty()) return timing;
      Timing there = timing_of(lower);
      if (holds(timing, there)) return timing;
      timing = std::move(there);
      sample = std::move(lower);
    }
    return timing;
  }

  /// Two clocks that run apart, if that is what the torque says: said, and taken out unless delays are to be kept.
  [[nodiscard]] bool judge_drift(const Sample& sample) {
    const std::optional<ClockDrifts> drifts = find_clock_drift(robot_, base_, out_.logs, sample.band_hz);
    if (!drifts) return false;
    const std::vector<int> files = file_numbers(out_.logs);
    for (std::size_t file = 0; file < drifts->files.size(); ++file) {
      const ClockDrift& drift = drifts->files[file];
      if (drift.rate == 0) continue;
      const std::string name = name_of_file(static_cast<int>(file));
      out_.findings.push_back(
          {.level = options_.keep_delay ? FindingLevel::warning : FindingLevel::mended,
           .key = "drift",
           .file = name,
           .value = drift.rate,
           .std = drift.rate_std,
           .text = fmt::format(
               "{}: torque and position have clocks of their own: the delay of the torque runs from {:+.2f} to {:+.2f} "
               "ms (+- {:.2g}) over the log: {} (residual {:.2g} % with one delay, {:.2g} % so)",
               name, 1e3 * drift.first_s, 1e3 * drift.last_s,
               1e3 * std::abs(drift.rate_std / drift.rate * (drift.last_s - drift.first_s)) / 2,
               options_.keep_delay ? "left in place" : "removed", 100 * drifts->rms_before, 100 * drifts->rms_after),
           .mend = "record torque and position with one clock"});
      for (std::size_t l = 0; l < out_.logs.size() && !options_.keep_delay; ++l) {
        if (files[l] == static_cast<int>(file)) take_drift_out(drift, out_.logs[l]);
      }
    }
    return true;
  }

  /// An offset of the torque is said, and taken out of the sample, so that it passes for nothing else.
  void judge_offset(Sample& sample) {
    std::optional<TorqueOffset> offset = torque_offset(robot_, base_, pick_points(sample, kPoints));
    if (!offset) return;
    for (Stretch& stretch : sample.stretches) stretch.tau.rowwise() -= offset->value.transpose();
    out_.findings.push_back(std::move(offset->finding));
  }

  void judge_timing(Sample sample) {
    Timing timing = steady_timing(sample);
    double noise = relative_torque_noise(out_.logs, sample);
    // A file in which little moves may only tell its drift once the others are free of theirs.
    for (int pass = 0; pass < 2 && judge_drift(sample); ++pass) {
      if (options_.keep_delay) return;
      sample = take_sample(out_.logs);
      timing = steady_timing(sample);
    }
    // Where the model does not hold in the whole band, what it lacks passes for a delay: the band is that of the model
    // then.
    if (const std::optional<Sample> narrow =
            timing.rms_after > clean(noise) ? within_model_band(sample) : std::nullopt) {
      timing = steady_timing(*narrow);
      noise = relative_torque_noise(out_.logs, *narrow);
    }
    const auto& [delay, lag] = timing.shift;
    if (!timing.significant) {
      const double std = timing.std.delay.maxCoeff();
      if (!(std > 0)) return;
      out_.findings.push_back({.key = "delay",
                               .value = 0,
                               .std = std,
                               .unit = "s",
                               .text = fmt::format("no delay between torque and position{}: 0 +- {:.2g} ms",
                                                   std < kSharp_s ? "" : " that this log could tell", 1e3 * std)});
      return;
    }
    const bool simple = lag.isZero(0) && delay.maxCoeff() == delay.minCoeff();
    const double longest = std::max(delay.cwiseAbs().maxCoeff(), lag.cwiseAbs().maxCoeff());
    const bool sharp =
        longest < kLongest_s && std::max(timing.std.delay.maxCoeff(), timing.std.lag.maxCoeff()) < kSharp_s;
    const bool sound = timing.rms_after < clean(noise) || timing.rms_after < kHalf * timing.rms_before;
    if (!sharp) {
      tell_vague(timing);
      return;
    }
    if (!simple && timing.rms_after > kWorthRemoving * timing.rms_before) return;
    if (!sound) {
      tell_doubtful(timing);
      return;
    }
    const bool remove = !options_.keep_delay;
    tell_timing(delay, timing.std.delay, timing, "delay", remove);
    tell_timing(lag, timing.std.lag, timing, "lag", remove);
    if (remove) mend(timing.shift);
  }

  /// The largest delay, or without any the largest lag, as a finding whose text says that of the torque.
  static LogFinding largest_of(const Timing& timing) {
    Index row = 0, column = 0;
    const bool lag = timing.shift.delay.isZero(0);
    const Eigen::MatrixXd& shift = lag ? timing.shift.lag : timing.shift.delay;
    shift.cwiseAbs().maxCoeff(&row, &column);
    LogFinding f{.key = lag ? "lag" : "delay",
                 .value = shift(row, column),
                 .std = (lag ? timing.std.lag : timing.std.delay)(row, column),
                 .unit = "s"};
    f.text = words_of_timing(f.key, "torque", f.value, f.std);
    return f;
  }

  /// A delay that the log does not tell well enough to be worth a warning: a figure for who asks.
  void tell_vague(const Timing& timing) {
    LogFinding f = largest_of(timing);
    f.text = fmt::format(
        "this log does not tell a delay: at best {}, residual {:.2g} % as recorded, {:.2g} % with that removed", f.text,
        100 * timing.rms_before, 100 * timing.rms_after);
    out_.findings.push_back(std::move(f));
  }

  /// A delay that explains part of the residual, but where much is left, stays where it is.
  void tell_doubtful(const Timing& timing) {
    if (timing.rms_after > kWorthSaying * timing.rms_before) return;
    LogFinding f = largest_of(timing);
    f.level = FindingLevel::warning;
    f.text += fmt::format(
        " as it seems, but that is not certain enough to remove it: residual {:.2g} % as recorded, {:.2g} % with it "
        "removed",
        100 * timing.rms_before, 100 * timing.rms_after);
    f.mend = "record a faster motion, or mend the delay where the log is made (delta-log import: delay in the map)";
    out_.findings.push_back(std::move(f));
  }

  /// One finding for all drives and logs alike, else one for each that differs.
  void tell_timing(const Eigen::MatrixXd& value, const Eigen::MatrixXd& std, const Timing& timing,
                   const std::string& key, bool removed) {
    const bool same_drives = (value.array().colwise() - value.col(0).array()).abs().maxCoeff() < 1e-9;
    const bool same_logs = (value.array().rowwise() - value.row(0).array()).abs().maxCoeff() < 1e-9;
    const Index L = same_logs ? 1 : value.rows(), n = same_drives ? 1 : value.cols();
    for (Index l = 0; l < L; ++l) {
      for (Index j = 0; j < n; ++j) {
        if (value(l, j) == 0) continue;
        const std::string who = same_drives ? "torque" : fmt::format("torque of drive {}", j + 1);
        out_.findings.push_back(
            {.level = removed ? FindingLevel::mended : FindingLevel::warning,
             .key = key,
             .file = same_logs ? "" : name_of_file(static_cast<int>(l)),
             .drive = same_drives ? -1 : static_cast<int>(j),
             .value = value(l, j),
             .std = std(l, j),
             .unit = "s",
             .text =
                 fmt::format("{}: {} (residual {:.2g} % as recorded, {:.2g} % with it removed)",
                             words_of_timing(key, who, value(l, j), std(l, j)), removed ? "removed" : "left in place",
                             100 * timing.rms_before, 100 * timing.rms_after),
             .mend = removed ? "" : "leave out --keep-delay, or mend the delay where the log is made"});
      }
    }
  }

  static std::string words_of_timing(const std::string& key, const std::string& who, double value, double std) {
    const std::string ms = fmt::format("{:.2f} +- {:.2g} ms", 1e3 * std::abs(value), 1e3 * std);
    if (key == "delay") return fmt::format("{} is {} {}", who, ms, value > 0 ? "late" : "early");
    return value > 0 ? fmt::format("{} is behind a low pass of {}", who, ms)
                     : fmt::format("{} is a command, which the motor follows with a lag of {}", who, ms);
  }

  [[nodiscard]] std::string name_of_file(int number) const {
    const std::vector<int> files = file_numbers(out_.logs);
    return out_.logs[static_cast<std::size_t>(std::find(files.begin(), files.end(), number) - files.begin())].file;
  }

  void mend(const Shifts& shifts) {
    const std::vector<int> files = file_numbers(out_.logs);
    for (std::size_t l = 0; l < out_.logs.size(); ++l) {
      Log& log = out_.logs[l];
      const double step = log.sample_time_s();
      const auto row = static_cast<Index>(files[l]);
      double farthest = 0;
      for (Index j = 0; j < log.drives(); ++j) {
        const double delay = shifts.delay(row, j), lag = shifts.lag(row, j);
        if (delay == 0 && lag == 0) continue;
        log.tau.col(j) = mend_timing(log.tau.col(j), step, delay, lag);
        farthest = std::abs(delay) > std::abs(farthest) ? delay : farthest;
      }
      // Where the moved torque reaches beyond the record, there is none.
      const auto lost = std::min<Index>(log.samples(), static_cast<Index>(std::ceil(std::abs(farthest) / step)));
      const Index begin = farthest > 0 ? log.samples() - lost : 0;
      if (lost > 0) log.leave_out(begin, begin + lost);
    }
  }

  void judge_scale(const Points& points) {
    if (prior_.size() != robot_.parameters() || prior_std_.size() != robot_.parameters()) return;
    // What explains the torque that badly may be another robot: its masses mean nothing.
    if (residual_ > kMassesMean) return;
    // An axis without a prior of its own has no masses to compare with: its simple shape is a stub.
    if (robot_.description().parts.empty() && !options_.prior_given) return;
    add(scale_findings(robot_.description(), estimate_scale(robot_, base_, points, prior_, prior_std_)));
  }

  const Robot& robot_;
  const Eigen::VectorXd& prior_;
  const Eigen::VectorXd& prior_std_;
  GateOptions options_;
  BaseParameters base_;
  double residual_ = 0;      ///< relative, as given; 0 if sound
  double torque_noise_ = 0;  ///< what the noise of the torque makes of it
  bool coarse_ = false;      ///< Sample::coarse
  GateResult out_;
};

}  // namespace

bool GateResult::fault() const {
  return std::ranges::count(findings, FindingLevel::fault, &LogFinding::level) > 0;
}

bool GateResult::stop() const {
  constexpr std::string_view kNoReasonToStop[] = {"scale", "torque_scale", "effort", "pose", "unexplained"};
  return std::ranges::any_of(findings, [&](const LogFinding& f) {
    return f.level == FindingLevel::fault && std::ranges::count(kNoReasonToStop, f.key) == 0;
  });
}

GateResult examine_logs(const Robot& robot, std::vector<Log> logs, const Eigen::VectorXd& prior,
                        const Eigen::VectorXd& prior_std, const GateOptions& options) {
  return Gate(robot, std::move(logs), prior, prior_std, options).run();
}

}  // namespace deltadyn
