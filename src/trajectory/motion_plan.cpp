#include "deltadyn/trajectory/motion_plan.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <optional>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

constexpr int kJoinPhases = 48;         // candidates for the phase where run-in and run-out meet the periodic motion
constexpr int kSearchSamples = 240;     // of a part while its duration is looked for
constexpr double kSearchMargin = 5e-4;  // so that the finer final check is passed, too
constexpr double kLongestRamp_s = 30;
constexpr double kRampGrowth = 1.15;    // of the durations that are tried
constexpr double kFineStep_s = 2.5e-4;  // of the final check
constexpr int kFewestFineSamples = 2000;

/// Smooth step 0 to 1 with two zero derivatives at both ends, its first derivative and its integral.
struct Step {
  double value, slope, integral;
};
Step step(double x) {
  x = std::clamp(x, 0.0, 1.0);
  const double x2 = x * x, x3 = x2 * x;
  return {x3 * (10 - 15 * x + 6 * x2), 30 * x2 * (1 - x) * (1 - x), x2 * x2 * (2.5 - 3 * x + x2)};
}

/// The curve of the series up to phase `join`, with the speed rising from rest, or on from there, with the speed
/// falling.
SmoothMotion ramp(PartKind kind, const FourierSeries& series, double join, double duration) {
  const double omega = series.omega(), sense = kind == PartKind::run_in ? 1 : -1;
  return {duration, [=](double t) {
            const Step s = step(sense > 0 ? t / duration : 1 - t / duration);
            return series.state(join - sense * omega * duration * (0.5 - s.integral), omega * s.value,
                                sense * omega * s.slope / duration);
          }};
}

SmoothMotion line(const Eigen::VectorXd& from, const Eigen::VectorXd& to, double duration) {
  return {duration, [from, to, duration](double t) -> TaskState {
            const double x = std::clamp(t / duration, 0.0, 1.0);
            const Step s = step(x);
            const Eigen::VectorXd way = to - from;
            const double curvature = 60 * x * (1 - x) * (1 - 2 * x);
            return {from + s.value * way, s.slope / duration * way, curvature / (duration * duration) * way};
          }};
}

enum class Way { along_curve, new_way };

/// What must be looked at. Along the curve of a motion that keeps its limits, never faster, positions and velocities
/// keep theirs anyway; a straight line between two poses inside stays inside the workspace, which is convex.
LimitCheck in_question(LimitCheck check, Way way) {
  std::erase_if(check.uses, [way](const LimitUse& use) {
    const LimitedQuantity quantity = use.limit.quantity;
    if (way == Way::new_way) return quantity == LimitedQuantity::region || quantity == LimitedQuantity::z;
    return quantity != LimitedQuantity::zdd && quantity != LimitedQuantity::qdd && quantity != LimitedQuantity::tau;
  });
  return check;
}

bool passed(const LimitCheck& check) {
  if (!check.reachable) return false;
  for (const LimitUse& use : check.uses) {
    // A line may begin where a drive is at the end of its range.
    const double margin = use.limit.quantity == LimitedQuantity::q ? 0.0 : kSearchMargin;
    if (!(use.load <= 1 - margin)) return false;
  }
  return true;
}

/// Shortest duration, a whole number of samples, with which the limits are kept.
struct Search {
  std::optional<double> duration;
  LimitCheck last;  ///< of the slowest try
};
template <class Make>
Search shortest(const Robot& robot, const MotionLimits& limits, Way way, double rate_hz, double first, double longest,
                Make make) {
  Search search;
  for (double wanted = first;; wanted *= kRampGrowth) {
    const double duration = std::ceil(std::min(wanted, longest) * rate_hz) / rate_hz;
    search.last = in_question(check_limits(robot, limits, make(duration), kSearchSamples), way);
    if (passed(search.last)) {
      search.duration = duration;
      return search;
    }
    if (wanted >= longest) return search;
  }
}

[[noreturn]] void refuse(const char* what, const LimitCheck& check) {
  if (!check.reachable)
    throw Error(fmt::format("no {} was found: the way leaves the reach of the robot", what), "",
                "make the workspace smaller", ExitCode::no_convergence);
  const LimitUse& use = check.tightest();
  throw Error(fmt::format("no {} keeps the limit '{}': {:.6g} {} where {:.6g} to {:.6g} is allowed", what,
                          use.limit.name, use.value, use.limit.unit, use.limit.lower, use.limit.upper),
              "", "widen this limit, or give --periodic", ExitCode::no_convergence);
}

int fine_samples(double duration_s) {
  return std::max(kFewestFineSamples, static_cast<int>(std::ceil(duration_s / kFineStep_s)));
}

struct Join {
  double phase = 0, in_s = 0, out_s = 0;
};

Join find_join(const Robot& robot, const PlanSegment& segment, double rate_hz) {
  const FourierSeries& series = segment.series;
  Join best;
  double best_time = std::numeric_limits<double>::infinity();
  LimitCheck last;
  const double first = 0.15;
  for (int k = 0; k < kJoinPhases; ++k) {
    const double phase = 2 * std::numbers::pi * k / kJoinPhases;
    // No longer than what is known already.
    const double allowed = std::min(kLongestRamp_s, best_time);
    const Search in = shortest(robot, segment.limits, Way::along_curve, rate_hz, first, allowed,
                               [&](double duration) { return ramp(PartKind::run_in, series, phase, duration); });
    last = in.last;
    if (!in.duration || *in.duration >= best_time) continue;
    const Search out = shortest(robot, segment.limits, Way::along_curve, rate_hz, first,
                                std::min(kLongestRamp_s, best_time - *in.duration),
                                [&](double duration) { return ramp(PartKind::run_out, series, phase, duration); });
    if (!out.duration || *in.duration + *out.duration >= best_time) continue;
    best = {phase, *in.duration, *out.duration};
    best_time = best.in_s + best.out_s;
  }
  if (!std::isfinite(best_time)) refuse("run-in", last);
  return best;
}

void append(MotionPlan& plan, PartKind kind, int segment, SmoothMotion motion) {
  const double duration = motion.duration_s;
  plan.parts.push_back({kind, segment, plan.duration_s, std::move(motion)});
  plan.duration_s += duration;
}

SmoothMotion periods(const FourierSeries& series, double phase, int count) {
  const double omega = series.omega();
  return {count * series.period_s(),
          [series, phase, omega](double t) { return series.state(phase + omega * t, omega, 0); }};
}

}  // namespace

TaskState MotionPlan::at(double t_s) const {
  std::size_t k = 0;
  while (k + 1 < parts.size() && t_s >= parts[k + 1].start_s - 1e-9) ++k;
  const PlanPart& part = parts[k];
  const double inside = std::max(0.0, t_s - part.start_s);
  return part.motion.at(part.kind == PartKind::periodic ? inside : std::min(inside, part.motion.duration_s));
}

FourierSeries on_sample_grid(const FourierSeries& series, double rate_hz) {
  FourierSeries result = series;
  result.base_frequency_hz = rate_hz / std::ceil(series.period_s() * rate_hz - 1e-6);
  return result;
}

SmoothMotion one_period(const FourierSeries& series) {
  return periods(series, 0.0, 1);
}

MotionPlan make_plan(const Robot& robot, const std::vector<PlanSegment>& segments, double rate_hz, bool periodic_only) {
  if (segments.empty() || (periodic_only && segments.size() > 1))
    throw Error("a plan without run-in and run-out has one segment", "--periodic", "leave out --periodic or --segments",
                ExitCode::usage);
  if (!(rate_hz > 0)) throw Error("the sample rate must be positive", "--rate-hz", "give e.g. 1000", ExitCode::usage);
  MotionPlan plan;
  Eigen::VectorXd pose;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const PlanSegment& segment = segments[k];
    const int number = static_cast<int>(k);
    if (periodic_only) {
      append(plan, PartKind::periodic, number, periods(segment.series, 0.0, segment.periods));
      continue;
    }
    const Join join = find_join(robot, segment, rate_hz);
    SmoothMotion in = ramp(PartKind::run_in, segment.series, join.phase, join.in_s);
    if (k > 0) {
      const Eigen::VectorXd to = in.at(0).z;
      const Search way = shortest(robot, segment.limits, Way::new_way, rate_hz, 0.2, kLongestRamp_s,
                                  [&](double duration) { return line(pose, to, duration); });
      if (!way.duration) refuse("way between two segments", way.last);
      append(plan, PartKind::transfer, number, line(pose, to, *way.duration));
    }
    append(plan, PartKind::run_in, number, std::move(in));
    append(plan, PartKind::periodic, number, periods(segment.series, join.phase, segment.periods));
    SmoothMotion out = ramp(PartKind::run_out, segment.series, join.phase, join.out_s);
    pose = out.at(join.out_s).z;
    append(plan, PartKind::run_out, number, std::move(out));
  }
  return plan;
}

LimitCheck check_plan(const Robot& robot, const std::vector<PlanSegment>& segments, const MotionPlan& plan) {
  LimitCheck check;
  for (const PlanPart& part : plan.parts) {
    const PlanSegment& segment = segments[static_cast<std::size_t>(part.segment)];
    const bool periodic = part.kind == PartKind::periodic;
    const SmoothMotion motion = periodic ? one_period(segment.series) : part.motion;
    check.merge(check_limits(robot, segment.limits, motion, fine_samples(motion.duration_s)), part.start_s);
  }
  return check;
}

TrajectorySamples sample_plan(const Robot& robot, const MotionPlan& plan, double rate_hz) {
  TrajectorySamples samples;
  const auto count = static_cast<Eigen::Index>(std::llround(plan.duration_s * rate_hz)) + 1;
  samples.t_s.resize(count);
  samples.z.resize(count, robot.drives());
  samples.zd = samples.zdd = samples.z;
  for (Eigen::Index i = 0; i < count; ++i) {
    samples.t_s(i) = static_cast<double>(i) / rate_hz;
    const TaskState task = plan.at(samples.t_s(i));
    samples.z.row(i) = task.z.transpose();
    samples.zd.row(i) = task.zd.transpose();
    samples.zdd.row(i) = task.zdd.transpose();
  }
  complete_drives(robot, samples);
  return samples;
}

}  // namespace deltadyn
