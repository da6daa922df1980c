#pragma once

/// \file
/// How delta-excite shares its time: the searches are planned for the time that was given, and ended in time for what
/// follows them. The same seed then gives the same file.

#include <algorithm>
#include <chrono>

#include "deltadyn/excitation/optimize.hpp"

#include "excite/search_flags.hpp"

namespace deltadyn::tools {

/// The clock starts with the object.
class TimeBudget {
 public:
  /// What is asked for besides the main trajectory.
  struct Wanted {
    bool torque = false;  ///< is limited, so that it is looked at
    bool validation = false, report = false;
  };

  TimeBudget(const SearchFlags& search, Wanted wanted)
      : wanted_(wanted),
        limit_s_(search.time_limit_s()),
        duration_s_(search.duration_s()),
        states_(search.bound_states()) {}

  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

  /// Sets the times of the first search, which begins now: what came before tells how fast this machine is.
  void plan_first(ExcitationOptions& options) {
    options.elapsed_s = seconds();
    estimate_following(options);
    options.planned_time_s = wanted_.validation ? (1 - kValidationShare) * limit_s_ : limit_s_;
    const double kept_for_report = wanted_.validation ? 0.0 : report_s_;
    options.time_limit_s = std::max(options.elapsed_s, options.planned_time_s - plan_s_ - kept_for_report);
  }

  /// Those of the search for the validation trajectory: as the first one planned for its share of the time, whatever
  /// that one took.
  void plan_second(ExcitationOptions& options) const {
    options.elapsed_s = std::max(seconds(), (1 - kValidationShare) * limit_s_);
    options.planned_time_s = kValidationShare * limit_s_;
    options.time_limit_s = std::max(options.elapsed_s, limit_s_ - plan_s_ - report_s_);
  }

 private:
  static constexpr double kValidationShare = 0.3;  // of the time
  // What follows a search, in units of the time that what precedes it took on this machine at this hour, measured with
  // SearchFlags::kUsualStates: run-in, run-out and final check of a segment; samples, a hundred thousand; the report,
  // which gnuplot makes slow.
  static constexpr double kPlanShare = 0.25, kSamplesShare = 0.8, kReportShare = 0.5;
  static constexpr double kReport_s = 0.6;  // at least

  void estimate_following(const ExcitationOptions& options) {
    const double unit = options.elapsed_s * std::min(1.0, static_cast<double>(SearchFlags::kUsualStates) / states_);
    const auto segments = static_cast<double>(options.speeds.size());
    plan_s_ = unit * segments * (kPlanShare + kSamplesShare * 1e-5 * duration_s_ * options.rate_hz);
    if (wanted_.torque) plan_s_ *= 2;
    if (wanted_.report) report_s_ = (0.5 + 0.5 * segments) * std::max(kReport_s, kReportShare * unit);
  }

  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  Wanted wanted_;
  double limit_s_, duration_s_;
  int states_;
  double plan_s_ = 0, report_s_ = 0;  // after a search: plan and samples; report
};

}  // namespace deltadyn::tools
