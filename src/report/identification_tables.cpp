#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "deltadyn/report/format.hpp"

#include "assessment_limits.hpp"
#include "drive_names.hpp"
#include "identification_sections.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;

constexpr double kInterval95 = 1.96;

const char* words_for(DecidedBy decided) {
  static constexpr const char* kWords[] = {"data", "both", "only sums", "prior", "neither"};
  return kWords[static_cast<std::size_t>(decided)];
}

const char* words_for(Visibility visibility) {
  static constexpr const char* kWords[] = {"on its own", "in sums", "not at all"};
  return kWords[static_cast<std::size_t>(visibility)];
}

/// "a, b and c", broken only between the items.
std::string unbroken_items(std::vector<std::string> items) {
  for (std::string& item : items) item = unbroken(item);
  return join_words(items);
}

}  // namespace

void add_fit_table(HtmlReport& report, const Robot& robot, const Identification& identification) {
  Table table({text_column("drive"), "rms residual", fmt::format("of the rms {}", units_of(robot, 0).effort),
               "free base parameters", "rows", "left out near reversals", "residual there / elsewhere"});
  for (std::size_t j = 0; j < identification.drives.size(); ++j) {
    const DriveReport& drive = identification.drives[j];
    const char* unit = units_of(robot, static_cast<int>(j)).torque;
    table.row({drive_name(static_cast<int>(j)), format_number(drive.rms, unit, 3),
               drive.rms_torque > 0 ? format_percent(drive.rms / drive.rms_torque) : "–",
               format_number(drive.rms_base, unit, 3), format_count(drive.rows), format_count(drive.masked_rows),
               fmt::format("{:.2f}", drive.reversal_ratio)});
  }
  report.table(table,
               "Residual of each drive with the physically consistent parameters, and with free base parameters, which "
               "nothing can undercut.");
}

void add_parameter_tables(HtmlReport& report, const Robot& robot, const Identification& identification) {
  const ConsistentFitSummary& fit = identification.fit;
  const std::vector<Visibility> visibility = parameter_visibility(identification.base);
  Table table({text_column("parameter"), text_column("unit"), "prior", "estimate ± 95 %", "data share",
               text_column("decided by"), text_column("shows in the torque")});
  Table others({text_column("parameter"), text_column("unit"), "prior", "value", text_column("shows in the torque")});
  bool any_neither = false;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const auto k = static_cast<Index>(i);
    const std::string unit = unbroken(pretty_unit(robot.parameter_units()[i]));
    if (!fit.fitted[i]) {
      others.row({parameter_name(fit.parameters[i]), unit, format_number(fit.prior(k)), format_number(fit.p(k)),
                  words_for(visibility[i])});
      continue;
    }
    const Source source = source_of(fit.data_share(k));
    const DecidedBy decided = decided_by(fit, visibility[i], k);
    const bool neither = decided == DecidedBy::neither;
    any_neither |= neither;
    table.row(
        {parameter_name(fit.parameters[i]), unit, format_number(fit.prior(k)),
         neither ? format_number(fit.p(k), 2) + " (?)" : format_estimate(fit.p(k), kInterval95 * fit.std(k)),
         fmt::format("{:.0f} %", 100 * fit.data_share(k)), words_for(decided), unbroken(words_for(visibility[i]))},
        source != Source::prior               ? Tone::plain
        : visibility[i] == Visibility::hidden ? Tone::muted
                                              : Tone::caution);
  }
  report.table(
      table,
      fmt::format(
          "Parameters of the consistent fit. Data share: how much of the prior's variance the data took away, where "
          "the prior counts with the weight that was chosen. Marked rows (below {:.0f} %) the data hardly tell: they "
          "lean on the prior and on the rest of their body; grey ones do not act on the drives at all.",
          100 * kPriorDecides));
  report.note(
      "A parameter that shows \"in sums\" acts on the drives only together with others: the sums are known as the base "
      "parameters below say, and with them the torque. Where \"only sums\" decided, the value by itself may be off by "
      "its whole interval. It matters if you use the body on its own.");
  if (any_neither) {
    report.note(
        "(?): neither the data nor the prior, at the weight that was chosen, hold the value; it moved to keep its body "
        "consistent. Take it as unknown. It acts too little on the torque to matter there.");
  }
  if (!others.empty()) {
    report.details("Parameters that were not fitted", [&](HtmlReport& inside) {
      inside.paragraph(
          "In the reduced set, products of inertia and moments across a symmetric link are zero, and inertias that the "
          "drives do not feel follow the prior.");
      inside.table(others);
    });
  }
}

void add_extras_table(HtmlReport& report, const Robot& robot, const Identification& identification) {
  Table table({text_column("joint"), text_column("what"), "figure ± std"});
  for (std::size_t joint = 0; joint < identification.presliding.size(); ++joint) {
    const PreslidingJoint& found = identification.presliding[joint];
    if (!(found.displacement > 0)) continue;
    const auto at = static_cast<int>(joint);
    const std::string name = at < robot.drives() ? drive_name(at) : robot.description().inner_joint();
    const char* unit = at < robot.drives() ? units_of(robot, at).position : (robot.description().plate ? "rad" : "m");
    table.row({name, "friction builds up after a reversal over",
               format_with_uncertainty(found.displacement, found.std, unit)});
    if (found.damping_s > 0)
      table.row(
          {"", "bristles damped by", format_with_uncertainty(1e3 * found.damping_s, 1e3 * found.damping_std_s, "ms")});
  }
  for (const Ripple& ripple : identification.processing.ripples) {
    const bool turning = turns(robot, ripple.drive);
    const double n = turning ? 1.0 : 1.0 / (2 * std::numbers::pi);
    table.row({drive_name(ripple.drive), "wave of the torque over the position (cogging, tooth meshing)",
               format_with_uncertainty(std::hypot(ripple.cosine, ripple.sine), ripple.amplitude_std,
                                       units_of(robot, ripple.drive).torque)});
    table.row(
        {"", "its waves", format_with_uncertainty(n * ripple.n, n * ripple.n_std, turning ? "a turn" : "a metre")});
  }
  if (table.empty()) return;
  report.table(table,
               "Found beside the parameters and part of the model: delta-validate takes them from the parameter file.");
}

void add_gap_table(HtmlReport& report, const std::vector<PriorGap>& gaps) {
  if (gaps.empty()) {
    report.paragraph("Nothing: the data decided every fitted parameter at least in part.");
    return;
  }
  Table table(
      {text_column("body or joint"), text_column("from the prior (data share)"), text_column("what would replace it")});
  for (const bool by_motion : {true, false}) {
    for (const PriorGap& gap : gaps) {
      if (gap.by_motion != by_motion) continue;
      table.row({owner_name(gap.first), unbroken_items(gap.parameters), gap.advice}, by_motion        ? Tone::caution
                                                                                     : gap.negligible ? Tone::muted
                                                                                                      : Tone::plain);
    }
  }
  report.table(table,
               "What is left to the prior. Marked rows would show in another motion of the drives. The others never "
               "show on their own: one value measured off the machine and entered in the prior with a small std "
               "sharpens the rest of its sum, too.");
}

void add_base_parameters(HtmlReport& report, const Identification& identification) {
  const BaseParameters& base = identification.base;
  const BaseEstimate& estimate = identification.base_estimate;
  const Eigen::VectorXd std = estimate.std();
  const Index count = base.count();
  Eigen::VectorXd index(count), deviation(count);
  Table table({"", text_column("base parameter"), text_column("unit"), "least squares ± std", "rel. std",
               "consistent fit", "deviation [std]"});
  Index poor = 0, far = 0;
  for (Index k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    index(k) = static_cast<double>(k + 1);
    deviation(k) = std(k) > 0 ? (identification.base_from_fit(k) - estimate.value(k)) / std(k) : 0.0;
    const double relative = std::abs(estimate.value(k)) > 0 ? std(k) / std::abs(estimate.value(k)) : HUGE_VAL;
    const bool hardly = relative > kPoorlySeen;
    poor += hardly ? 1 : 0;
    far += std::abs(deviation(k)) > kRemarkableDeviation ? 1 : 0;
    table.row(
        {fmt::format("{}", k + 1), base.expressions[i], pretty_unit(base.units[i]),
         format_with_uncertainty(estimate.value(k), std(k)), relative < 10 ? format_percent(relative, 2) : "> 1000 %",
         format_number(identification.base_from_fit(k)), fmt::format("{:+.2f}", deviation(k))},
        hardly ? Tone::caution : Tone::plain);
  }
  report.paragraph(
      fmt::format("{} combinations of the {} parameters are all that the drives can feel. {} of them {} hardly seen "
                  "(relative std above {:.0f} %, marked); condition number {}.",
                  count, base.B.cols(), poor, poor == 1 ? "is" : "are", 100 * kPoorlySeen,
                  format_number(estimate.condition_number, 3)));
  report.plot(
      {.x_label = "base parameter (number in the table)",
       .y_label = "deviation [std]",
       .series = {{"", index, deviation, SeriesStyle::impulses, {}, PlotColor::blue},
                  {"", index, deviation, SeriesStyle::points, {}, PlotColor::blue}},
       .horizontal_markers = {{2.0, "+2 std"}, {-2.0, "-2 std"}},
       .x_range = PlotRange{0.0, static_cast<double>(count + 1)},
       .height = 220},
      fmt::format("Consistent fit minus least squares, in standard deviations of the least squares. {}",
                  far == 0 ? "Physical consistency and prior leave the base parameters within their noise."
                           : fmt::format("{} {} by more than {:.0f}: there prior or consistency pull against the data.",
                                         far, far == 1 ? "differs" : "differ", kRemarkableDeviation)));
  report.details(fmt::format("The {} base parameters", count), [&](HtmlReport& inside) {
    inside.table(table, "Base parameters. Rows are marked where the data hardly tell the value from zero.");
  });
}

}  // namespace deltadyn
