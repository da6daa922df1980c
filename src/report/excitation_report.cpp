#include "deltadyn/report/excitation_report.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>
#include <utility>

#include "deltadyn/report/format.hpp"
#include "deltadyn/report/html_report.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/trajectory/task_columns.hpp"

#include "assessment_parts.hpp"
#include "drive_names.hpp"
#include "excitation_figures.hpp"

namespace deltadyn {
namespace {

// Standard deviations, as shares of the expected size, from which a base parameter counts as known, and beyond which as
// not identified.
constexpr double kWell = 0.05, kNot = 0.5;
constexpr double kGoodEfficiency = 0.6, kFairEfficiency = 0.4;
constexpr double kBinding = 0.99;
// Share of base parameters that any usual motion hardly shows.
constexpr double kFewBlind = 0.25;

double relative_std(const ExcitationReportInput& input, Eigen::Index k) {
  return input.predicted_std(k) / std::max(input.base_scale(k), 1e-300);
}

/// How well the motion shows a base parameter.
enum Seen { well, roughly, hardly };
Seen seen(double relative) {
  return relative <= kWell ? well : (relative <= kNot ? roughly : hardly);
}

int count_of(const ExcitationReportInput& input, Seen level) {
  int count = 0;
  for (Eigen::Index k = 0; k < input.predicted_std.size(); ++k) count += seen(relative_std(input, k)) == level ? 1 : 0;
  return count;
}

Check check_efficiency(const ExcitationReportInput& input) {
  const double efficiency = input.excitation.d_efficiency;
  Check check{"Information", fmt::format("D-efficiency {}", format_percent(efficiency, 3)), Verdict::good, ""};
  // The bound may be out of reach for any motion: what the motion will leave unknown decides whether little information
  // is too little.
  const bool blind = count_of(input, hardly) > kFewBlind * static_cast<double>(input.base.count());
  if (efficiency < kGoodEfficiency)
    check.verdict = efficiency < kFairEfficiency && blind ? Verdict::bad : Verdict::caution;
  check.meaning = "That share of the information which any states inside these limits could give.";
  if (check.verdict == Verdict::bad)
    check.meaning += fmt::format(" Of {} base parameters {} will not be known to half of their size.",
                                 input.base.count(), count_of(input, hardly));
  if (check.verdict != Verdict::good)
    check.meaning += " More time (--time-limit-s), a larger workspace or a wider --base-frequency-hz may give more.";
  const bool plate_is_free = std::ranges::any_of(input.excitation.segments, [](const Excitation::Segment& segment) {
    const MotionLimits& limits = segment.limits;
    return limits.zd.size() >= 3 && !(limits.zd.head<3>().allFinite() && limits.zdd.head<3>().allFinite());
  });
  if (check.verdict != Verdict::good && plate_is_free)
    check.meaning +=
        " The share counts plate speeds that the drives allow, also those for which the workspace leaves no room: "
        "--platform-velocity-m-s and --platform-acceleration-m-s2 say what the machine is to do.";
  return check;
}

Check check_reversals(const ExcitationReportInput& input) {
  Check check{"Rows that an identification can use", "velocity reversals were not looked at", Verdict::good, ""};
  if (input.away_from_reversals.size() == 0) return check;
  const Eigen::VectorXd least = input.away_from_reversals.rowwise().minCoeff();
  Eigen::Index worst = 0;
  const double share = least.minCoeff(&worst);
  check.figure = fmt::format("{} of the rows of {} are away from velocity reversals", format_percent(share, 2),
                             drive_name(static_cast<int>(worst)));
  check.meaning = fmt::format("In every segment, for an identification at a cut-off of {}.",
                              format_number(input.reversal_cutoff_hz, "Hz", 3));
  // What the smooth share of the search is off by.
  constexpr double kRounding = 0.02;
  if (share < input.least_away - kRounding) {
    check.verdict = Verdict::caution;
    check.meaning += fmt::format(
        " Less than the {} asked for: give more --time-limit-s, a lower upper end of --base-frequency-hz, or a wider "
        "workspace.",
        format_percent(input.least_away, 2));
  }
  return check;
}

void add_key_figures(HtmlReport& report, const ExcitationReportInput& input) {
  const Excitation& e = input.excitation;
  report.key_figures({
      {"D-efficiency", format_percent(e.d_efficiency, 3),
       fmt::format("bound known to {}", format_percent(input.bound.gap(input.base.count()), 1)),
       e.d_efficiency >= kGoodEfficiency ? Tone::good : Tone::caution},
      {"margin to the limits", format_percent(input.check.margin(), 2), input.check.tightest().limit.name, Tone::plain},
      {"condition number", format_number(e.condition_number, 4), "columns scaled", Tone::plain},
      {"length", format_number(input.plan.duration_s, "s", 4),
       fmt::format("{} samples", format_count(input.samples.samples())), Tone::plain},
      {"base parameters", fmt::format("{} of {}", input.base.count(), input.robot.parameters()), "columns",
       Tone::plain},
      {"search", format_duration(e.total_time_s),
       fmt::format("first motion after {}", format_duration(e.first_feasible_time_s)), Tone::plain},
  });
}

void add_limit_table(HtmlReport& report, const ExcitationReportInput& input) {
  Table table({text_column("limit"), "lower", "upper", "reached", text_column("unit"), "used", "at [s]"});
  for (const LimitUse& use : input.check.uses) {
    table.row({use.limit.name, format_number(use.limit.lower, 4), format_number(use.limit.upper, 4),
               format_number(use.value, 4), pretty_unit(use.limit.unit), format_percent(use.load, 4),
               format_number(use.time_s, 4)},
              use.load > kBinding ? Tone::strong : Tone::plain);
  }
  report.table(table, "Limits in bold type bind: wider ones would allow a better motion.");
}

void add_identification_table(HtmlReport& report, const ExcitationReportInput& input) {
  std::string noise;
  for (Eigen::Index i = 0; i < input.torque_noise.size(); ++i) {
    noise += (i > 0 ? ", " : "") +
             format_number(input.torque_noise(i), units_of(input.robot, static_cast<int>(i)).torque, 3);
  }
  report.paragraph(fmt::format(
      "Predicted standard deviations for one run of this trajectory with white torque noise of {} in the drives. "
      "Expected values are those of {}; the last column but one is the standard deviation as a share of the size that "
      "the combination may have.",
      noise, input.values_are_nominal ? "simple shapes; give --params for better ones" : "the given model"));
  std::vector<Eigen::Index> order(static_cast<std::size_t>(input.base.count()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::ranges::stable_sort(
      order, [&](Eigen::Index a, Eigen::Index b) { return relative_std(input, a) > relative_std(input, b); });
  constexpr const char* kWords[] = {"well", "roughly", "hardly"};
  constexpr Tone kTones[] = {Tone::plain, Tone::caution, Tone::bad};
  const auto fill = [&](Table& table, bool only_hidden) {
    for (const Eigen::Index k : order) {
      const double relative = relative_std(input, k);
      if (only_hidden && relative <= kNot) continue;
      const auto at = static_cast<std::size_t>(k);
      const std::string unit(pretty_unit(input.base.units[at]));
      table.row(
          {input.base.expressions[at], format_number(input.base_values(k), 4), format_number(input.predicted_std(k), 3),
           unit, relative > 10 ? "–" : format_percent(relative, 2), kWords[seen(relative)]},
          kTones[seen(relative)]);
    }
  };
  const std::vector<TableColumn> columns = {text_column("combination of parameters"),
                                            "expected",
                                            "standard deviation",
                                            text_column("unit"),
                                            "share",
                                            text_column("seen")};
  report.subheading("What the motion will hardly identify");
  Table hidden(columns);
  fill(hidden, true);
  if (hidden.empty()) {
    report.paragraph("Nothing: every combination will be known to half of its size or better.");
  } else {
    report.table(hidden,
                 "Their effect on the torque is small in every motion inside these limits, or of this length; more "
                 "periods lower the standard deviation with the root of their number.");
  }
  report.details("All base parameters, the least visible first", [&](HtmlReport& inner) {
    Table all(columns);
    fill(all, false);
    inner.table(all);
  });
  // Parameters that enter no combination at all.
  std::vector<std::string> none;
  for (Eigen::Index k = 0; k < input.base.B.cols(); ++k) {
    if (input.base.B.col(k).cwiseAbs().maxCoeff() <= 0)
      none.push_back(input.robot.parameter_names()[static_cast<std::size_t>(k)]);
  }
  if (!none.empty())
    report.note(fmt::format("No motion of the drives shows these parameters: {}.", fmt::join(none, ", ")));
}

void add_settings(HtmlReport& report, const ExcitationReportInput& input, const ReportContext& context) {
  const Excitation& e = input.excitation;
  Facts facts = {{"Robot file", context.robot_file}};
  if (!context.parameter_file.empty()) facts.emplace_back("Model", context.parameter_file);
  if (input.segments.front().limits.region)
    facts.emplace_back("Workspace", input.segments.front().limits.region->text());
  for (std::size_t k = 0; k < input.segments.size(); ++k) {
    const FourierSeries& series = input.segments[k].series;
    facts.emplace_back(fmt::format("Segment {}", k + 1),
                       fmt::format("{} harmonics of {}, {} periods of {}", series.harmonics(),
                                   format_number(series.base_frequency_hz, "Hz", 5), input.segments[k].periods,
                                   format_number(series.period_s(), "s", 5)));
  }
  facts.emplace_back(
      "Search", fmt::format("{} of {} starts and polishing runs, {} evaluations with gradient, {}", e.finished_starts,
                            e.starts, format_count(e.evaluations), format_duration(e.total_time_s)));
  facts.emplace_back(
      "Upper bound",
      fmt::format(
          "approximate D-optimal design over {} random admissible states, {} of them with a share, certified to {}",
          format_count(input.bound.shares.size()), input.bound.support,
          format_percent(input.bound.gap(input.base.count()), 2)));
  report.facts(facts);
}

}  // namespace

Assessment assess_excitation(const ExcitationReportInput& input) {
  const Excitation& e = input.excitation;
  Assessment out;
  out.checks = {check_efficiency(input), check_reversals(input)};
  const Check& worst = worst_of(out.checks);
  out.verdict = worst.verdict;
  out.headline = out.verdict == Verdict::good      ? "A good excitation"
                 : out.verdict == Verdict::caution ? "A usable excitation: " + worst.figure
                                                   : "A weak excitation: " + worst.figure;
  out.lines.push_back(fmt::format(
      "The machine can run it: every limit is kept, between the samples too; the tightest one ({}) with {} to spare.",
      input.check.tightest().limit.name, format_percent(input.check.margin(), 2)));
  for (const Check& check : out.checks)
    out.lines.push_back(fmt::format("{}: {}. {}", check.subject, check.figure, check.meaning));
  out.lines.push_back(
      fmt::format("Of {} base parameters {} will be known to {} of their size or better, {} roughly, {} hardly.",
                  input.base.count(), count_of(input, well), format_percent(kWell, 1), count_of(input, roughly),
                  count_of(input, hardly)));
  if (e.out_of_time)
    out.lines.emplace_back("The search was stopped by its time limit; more time may find a better motion.");
  if (e.interrupted) out.lines.emplace_back("The search was interrupted; more time may find a better motion.");
  return out;
}

std::string excitation_report(const ExcitationReportInput& input, const ReportContext& context) {
  const auto p = static_cast<Eigen::Index>(input.base.count());
  if (input.predicted_std.size() != p || input.base_values.size() != p || input.base_scale.size() != p ||
      input.samples.z.cols() != input.robot.drives() || input.plan.parts.empty() || input.segments.empty())
    throw Error("trajectory, base parameters and plan are not those of this robot", input.robot.description().name,
                "make them with the same robot", ExitCode::usage);
  const RobotDescription& description = input.robot.description();
  HtmlReport report("Excitation of " + description.name,
                    fmt::format("{}, {:.4g} s", robot_in_words(description), input.plan.duration_s));
  const Assessment assessment = assess_excitation(input);
  report.verdict(assessment.verdict, assessment.headline, assessment.lines);
  add_key_figures(report, input);
  report.heading("Path");
  add_path_figures(report, input);
  report.heading("Limits");
  add_limit_figures(report, input);
  add_limit_table(report, input);
  report.heading("What the motion will identify");
  add_identification_table(report, input);
  report.heading("Settings");
  add_settings(report, input, context);
  report.footer(context.command_line);
  return report.str();
}

}  // namespace deltadyn
