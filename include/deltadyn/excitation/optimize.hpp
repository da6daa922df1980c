#pragma once

/// \file
/// Optimal excitation trajectories, paper IV.B: (8)-(11) with exact gradients, several starts side by side.

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "deltadyn/excitation/criterion.hpp"
#include "deltadyn/excitation/design_bound.hpp"
#include "deltadyn/excitation/design_space.hpp"
#include "deltadyn/trajectory/fourier_series.hpp"
#include "deltadyn/trajectory/limit_check.hpp"

namespace deltadyn {

struct ExcitationOptions : MotionGoal {
  std::vector<double> speeds = {1.0};  ///< one a segment: share of the velocity limits
  double time_limit_s = 60;            ///< of the search, from `elapsed_s` on
  double elapsed_s = 0;                ///< spent before, counts for the figures and the limit
  double planned_time_s = 0;           ///< that starts and rounds are planned for; 0: the time limit
  /// Random starts of each segment; 0: as many as two threads of a desktop machine finish in 60 % of the planned time.
  /// The work is counted in evaluations, so that the result does not depend on the machine unless the time runs out.
  int starts = 0;
  double rate_hz = 1000;  ///< the period becomes a whole number of samples
  std::uint64_t seed = 1;
  const std::atomic<bool>* stop = nullptr;  ///< set by Ctrl-C: end soon with the best motion so far
  std::function<void(double share)> progress;

  /// Throws deltadyn::Error(usage) that names the flag.
  void validate() const;
};

struct Excitation {
  struct Segment {
    FourierSeries series;
    MotionLimits limits;          ///< at the speed of this segment
    LimitCheck check;             ///< of its period, between the samples too
    Eigen::MatrixXd information;  ///< a sample, scaled columns, true Coulomb signs
    long evaluations = 0;         ///< of value and gradient; 0: no time was left, the motion is a random one
  };
  std::vector<Segment> segments;
  Eigen::MatrixXd information;  ///< mean of the segments, by equal shares of time
  double log_det = 0;           ///< of it, in scaled columns
  double log_det_physical = 0;  ///< in the columns' own units (torque weighted)
  double d_efficiency = 0;      ///< against the bound
  double condition_number = 0;  ///< of the weighted regressor in scaled columns: square root of that of M
  double value = 0;             ///< of the criterion
  double first_feasible_time_s = 0, first_feasible_efficiency = 0, total_time_s = 0;
  int starts = 0, finished_starts = 0;
  long evaluations = 0;
  bool out_of_time = false, interrupted = false;

  [[nodiscard]] double margin() const;
  [[nodiscard]] std::string brief_report() const;
};

/// Throws deltadyn::Error: usage or bad_input for limits and options that cannot be met, no_convergence if no feasible
/// motion was found in time; it names the limit that is violated at rest in the pose with the most room.
[[nodiscard]] Excitation optimize_excitation(const DesignSpace& space, const MotionLimits& limits,
                                             const DesignBound& bound, const ExcitationOptions& options);

/// A random Fourier motion that keeps all limits: what a start begins with. Amplitudes are as large as the limits let
/// them be.
[[nodiscard]] FourierSeries random_feasible_series(const DesignSpace& space, const MotionLimits& limits,
                                                   const ExcitationOptions& options, std::uint64_t seed);

/// Information of one period a sample, scaled columns, true Coulomb signs.
[[nodiscard]] Eigen::MatrixXd series_information(const DesignSpace& space, const FourierSeries& series,
                                                 int samples = 2000);

}  // namespace deltadyn
