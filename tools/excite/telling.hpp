#pragma once

/// \file
/// What delta-excite says of a motion, on the terminal and in the summary.

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <string>
#include <vector>

#include "deltadyn/io/summary.hpp"
#include "deltadyn/report/excitation_report.hpp"

namespace deltadyn::tools {

/// Shares away from reversals, drives x segments.
/// \param of  the motion: empty for the main one
inline void tell_reversals(const Eigen::MatrixXd& away, const std::string& of, double cutoff_hz, Summary& out) {
  for (Eigen::Index k = 0; k < away.cols(); ++k) {
    std::vector<std::string> shares;
    for (Eigen::Index i = 0; i < away.rows(); ++i) {
      shares.push_back(fmt::format("{:.0f}", 100 * away(i, k)));
      out.add(fmt::format("away_from_reversals_{}segment{}_drive{}", of.empty() ? "" : of + "_", k + 1, i + 1),
              away(i, k));
    }
    fmt::print(
        "{}{}segment {}: {} % of the rows of drives 1..{} away from velocity reversals, at a cut-off of {:.3g} Hz\n",
        of, of.empty() ? "" : ", ", k + 1, fmt::join(shares, ", "), shares.size(), cutoff_hz);
  }
}

inline std::vector<std::string> binding_limits(const LimitCheck& check) {
  std::vector<std::string> names;
  for (const LimitUse& use : check.uses)
    if (use.load > 0.99) names.push_back(use.limit.name);
  return names;
}

/// What the search might have found with more room or more time.
inline void tell_shortcomings(const Excitation& excitation, const ExcitationOptions& options) {
  constexpr int kFewestEvaluations = 20;  // of a search that deserves the name
  const auto& segments = excitation.segments;
  const bool at_highest = std::any_of(segments.begin(), segments.end(), [&](const Excitation::Segment& segment) {
    return segment.series.base_frequency_hz > 0.99 * options.highest_hz;
  });
  if (at_highest && options.highest_hz > options.lowest_hz)
    fmt::print(
        "note: the base frequency is at its upper end; a wider --base-frequency-hz or more --harmonics may show "
        "more\n");
  for (std::size_t k = 0; k < segments.size(); ++k) {
    if (segments[k].evaluations >= kFewestEvaluations) continue;
    fmt::print(
        "note: the time was over before segment {} could be made better; it keeps the limits, but shows little. Give "
        "more "
        "--time-limit-s\n",
        k + 1);
  }
}

/// The motion in words.
inline void tell_motion(const ExcitationReportInput& input, const ExcitationOptions& options, Summary& out) {
  const Excitation& e = input.excitation;
  fmt::print("{}\n", e.brief_report());
  fmt::print("{} base parameters of {} columns, {} samples in {:.3f} s\n", input.base.count(), input.robot.parameters(),
             input.samples.samples(), input.plan.duration_s);
  for (std::size_t k = 0; k < e.segments.size(); ++k) {
    const FourierSeries& series = e.segments[k].series;
    fmt::print("segment {}: base frequency {:.5g} Hz, {} periods of {:.4g} s\n", k + 1, series.base_frequency_hz,
               input.segments[k].periods, series.period_s());
    out.add(fmt::format("base_frequency_segment{}", k + 1), series.base_frequency_hz, "Hz");
    out.add(fmt::format("periods_segment{}", k + 1), input.segments[k].periods);
  }
  const std::vector<std::string> binding = binding_limits(input.check);
  fmt::print("limits used to 99 % or more: {}\n",
             binding.empty() ? "none" : fmt::format("{}", fmt::join(binding, ", ")));
  fmt::print("margin {:.3g} of the tightest limit ({}), between the samples, too\n", input.check.margin(),
             input.check.tightest().limit.name);
  fmt::print("first feasible motion after {:.2f} s\n", e.first_feasible_time_s);
  tell_shortcomings(e, options);
}

/// Figures for scripts.
inline void summarise_motion(const ExcitationReportInput& input, const std::string& criterion, double total_s,
                             Summary& out) {
  const Excitation& e = input.excitation;
  out.add("d_efficiency", e.d_efficiency);
  out.add("constraint_margin", input.check.margin());
  out.add("tightest_limit", input.check.tightest().limit.name);
  out.add("binding_limits", fmt::format("{}", fmt::join(binding_limits(input.check), "; ")));
  out.add("log_det", e.log_det_physical);
  out.add("condition_number", e.condition_number);
  out.add("criterion", criterion);
  out.add("criterion_value", e.value);
  out.add("base_parameters", input.base.count());
  out.add("columns", input.robot.parameters());
  out.add("samples", input.samples.samples());
  out.add("duration_s", input.plan.duration_s, "s");
  out.add("bound_gap", input.bound.gap(input.base.count()));
  out.add("bound_support", input.bound.support);
  out.add("first_feasible_time_s", e.first_feasible_time_s, "s");
  out.add("first_feasible_efficiency", e.first_feasible_efficiency);
  out.add("total_time_s", total_s, "s");
  out.add("evaluations", e.evaluations);
  out.add("starts", e.starts);
  out.add("finished_starts", e.finished_starts);
  out.add("stopped", e.interrupted ? "interrupted" : (e.out_of_time ? "time" : "completed"));
}

}  // namespace deltadyn::tools
