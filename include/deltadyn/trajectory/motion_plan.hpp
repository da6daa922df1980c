#pragma once

/// \file
/// From Fourier series to a motion a controller can run: from rest, along the same curve with rising speed into the
/// periodic motion, and out of it again; several such segments one after the other.

#include <vector>

#include "deltadyn/trajectory/fourier_series.hpp"
#include "deltadyn/trajectory/limit_check.hpp"
#include "deltadyn/trajectory/samples.hpp"

namespace deltadyn {

enum class PartKind { transfer, run_in, periodic, run_out };

struct PlanPart {
  PartKind kind = PartKind::periodic;
  int segment = 0;
  double start_s = 0;
  SmoothMotion motion;
};

struct PlanSegment {
  FourierSeries series;  ///< its period is a whole number of samples
  MotionLimits limits;   ///< that this segment keeps
  int periods = 1;
};

struct MotionPlan {
  std::vector<PlanPart> parts;
  double duration_s = 0;
  [[nodiscard]] TaskState at(double t_s) const;
};

/// The same series with the next lower base frequency whose period is a whole number of sample times.
[[nodiscard]] FourierSeries on_sample_grid(const FourierSeries& series, double rate_hz);

/// The periodic motion of a series, from phase 0.
[[nodiscard]] SmoothMotion one_period(const FourierSeries& series);

/// \param periodic_only  leave out run-in, run-out and transfers; then one segment only
/// Run-in: the phase starts at rest and reaches its rate after the shortest time (a whole number of samples) with which
/// all limits are kept; the phase where it joins is chosen for that. Transfers are straight lines. Throws
/// deltadyn::Error(no_convergence) that names the limit that stands in the way.
[[nodiscard]] MotionPlan make_plan(const Robot& robot, const std::vector<PlanSegment>& segments, double rate_hz,
                                   bool periodic_only);

/// Largest use of every limit over the whole plan, between the samples too.
[[nodiscard]] LimitCheck check_plan(const Robot& robot, const std::vector<PlanSegment>& segments,
                                    const MotionPlan& plan);

/// Task space and drives at the controller's rate.
[[nodiscard]] TrajectorySamples sample_plan(const Robot& robot, const MotionPlan& plan, double rate_hz);

}  // namespace deltadyn
