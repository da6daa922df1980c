#pragma once

/// \file
/// A motion that was searched for, as a controller can run it and as it was checked.

#include <Eigen/Core>
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include "deltadyn/excitation/optimize.hpp"
#include "deltadyn/excitation/reversals.hpp"
#include "deltadyn/identification/log_processing.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/trajectory/motion_plan.hpp"

namespace deltadyn::tools {

/// What belongs to one trajectory file.
struct PlannedMotion {
  Excitation excitation;
  std::vector<PlanSegment> segments;
  MotionPlan plan;
  LimitCheck check;
  TrajectorySamples samples;
};

/// \param duration_s  of the periodic part of each segment, at least
/// \param periodic    without run-in and run-out
/// Throws Error(no_convergence) if the motion breaks a limit or does not show all base parameters.
inline PlannedMotion plan_excitation(const DesignSpace& space, const MotionLimits& limits, const DesignBound& bound,
                                     const ExcitationOptions& options, const Robot& robot, double duration_s,
                                     bool periodic) {
  PlannedMotion out;
  out.excitation = optimize_excitation(space, limits, bound, options);
  for (const Excitation::Segment& segment : out.excitation.segments) {
    const int periods = static_cast<int>(std::ceil(duration_s / segment.series.period_s() - 1e-9));
    out.segments.push_back({segment.series, segment.limits, periods});
  }
  out.plan = make_plan(robot, out.segments, options.rate_hz, periodic);
  out.check = check_plan(robot, out.segments, out.plan);
  if (out.check.margin() < 0) {
    const LimitUse& use = out.check.tightest();
    throw Error(fmt::format("the motion breaks the limit '{}' at {:.4f} s: {:.8g} {}", use.limit.name, use.time_s,
                            use.value, use.limit.unit),
                "", "give more time, or another --seed", ExitCode::no_convergence);
  }
  if (!(out.excitation.d_efficiency > 0))
    throw Error("the motion found keeps the limits, but does not show all base parameters", "--time-limit-s",
                "give more time", ExitCode::no_convergence);
  out.samples = sample_plan(robot, out.plan, options.rate_hz);
  return out;
}

/// Shares of the time away from velocity reversals, drives x segments, over the periodic part of each.
inline Eigen::MatrixXd away_from_reversals(const Robot& robot, const std::vector<PlanSegment>& segments,
                                           const ExcitationOptions& options) {
  Eigen::MatrixXd shares(robot.drives(), static_cast<Eigen::Index>(segments.size()));
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const MotionPlan plan = make_plan(robot, {segments[k]}, options.rate_hz, true);
    shares.col(static_cast<Eigen::Index>(k)) = share_away_from_reversals(
        robot, sample_plan(robot, plan, options.rate_hz), options.reversal_reach_s, ProcessingOptions{}.reversal_floor);
  }
  return shares;
}

}  // namespace deltadyn::tools
