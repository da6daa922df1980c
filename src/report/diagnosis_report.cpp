#include "deltadyn/report/diagnosis_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <functional>

#include "deltadyn/report/diagnosis_text.hpp"
#include "deltadyn/report/format.hpp"
#include "deltadyn/report/html_report.hpp"
#include "deltadyn/report/log_report.hpp"

#include "drive_names.hpp"

namespace deltadyn {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr int kBins = 40;
constexpr Index kMostPoints = 1500;  // of a curve over time: more than a screen shows

std::string p_text(double p) {
  return p < 1e-4 ? "below 0.0001" : format_number(p, 2);
}

Verdict verdict_of(const Diagnosis& d) {
  const bool proven = d.verdict == DiagnosisVerdict::named && !(shows_gap(d) && d.gap_shrink <= 0.5);
  return d.verdict == DiagnosisVerdict::nothing_missing || proven ? Verdict::good : Verdict::caution;
}

/// Means of the residual in bins of a coordinate, with the standard error of each.
struct BinnedResidual {
  VectorXd x, before, after, error;
};

using TraceCoordinate = double (*)(const DiagnosisTrace&, Index row, int drive);

/// Of the training logs.
BinnedResidual binned(const Diagnosis& d, int drive, TraceCoordinate coordinate) {
  std::vector<std::array<double, 3>> points;  // x, before, after
  for (const DiagnosisTrace& trace : d.traces) {
    if (trace.holdout) continue;
    for (Index k = 0; k < trace.t_s.size(); ++k) {
      if (trace.usable(k, drive))
        points.push_back({coordinate(trace, k, drive), trace.before(k, drive), trace.after(k, drive)});
    }
  }
  std::ranges::sort(points);
  const auto bins = static_cast<std::size_t>(std::min<std::size_t>(kBins, points.size() / 10));
  BinnedResidual out;
  for (VectorXd* v : {&out.x, &out.before, &out.after, &out.error}) *v = VectorXd::Zero(static_cast<Index>(bins));
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t first = b * points.size() / bins, last = (b + 1) * points.size() / bins;
    const auto count = static_cast<double>(last - first);
    const auto at = static_cast<Index>(b);
    double square = 0;
    for (std::size_t k = first; k < last; ++k) {
      out.x(at) += points[k][0] / count;
      out.before(at) += points[k][1] / count;
      out.after(at) += points[k][2] / count;
      square += points[k][1] * points[k][1] / count;
    }
    out.error(at) = std::sqrt(std::max(0.0, square - out.before(at) * out.before(at)) / count);
  }
  return out;
}

PlotSpec map_of(const Diagnosis& d, const Robot& robot, int drive, const std::string& x_label, const std::string& title,
                TraceCoordinate coordinate) {
  const BinnedResidual bins = binned(d, drive, coordinate);
  PlotSpec plot{.title = title,
                .x_label = x_label,
                .y_label = fmt::format("mean residual [{}]", units_of(robot, drive).torque),
                .horizontal_markers = {{0.0, ""}},
                .height = 230};
  plot.series.push_back({"model fitted to these logs, with standard error", bins.x, bins.before, SeriesStyle::errorbars,
                         bins.error, PlotColor::vermillion});
  if (!d.named.empty())
    plot.series.push_back({"with the named effect", bins.x, bins.after, SeriesStyle::line, {}, PlotColor::blue});
  return plot;
}

/// The drives worth a picture: those that a named effect reaches or that have structure, or else all.
std::vector<int> drives_to_show(const Diagnosis& d) {
  std::vector<int> out, all;
  for (std::size_t j = 0; j < d.drives.size(); ++j) {
    const bool reached = std::ranges::any_of(
        d.named, [j](const NamedEffect& one) { return std::ranges::count(one.drives, static_cast<int>(j)) > 0; });
    all.push_back(static_cast<int>(j));
    if (reached || (d.named.empty() && d.drives[j].structure > 0.1)) out.push_back(static_cast<int>(j));
  }
  return out.empty() ? all : out;
}

VectorXd thinned(const VectorXd& x, Index step) {
  return x(Eigen::seqN(0, (x.size() + step - 1) / step, step));
}

void step_1(HtmlReport& report, const Diagnosis& d, const Robot& robot) {
  report.heading("1. Does the model fit?");
  report.paragraph(
      "For each drive, rms on the training logs: what the parameters as given leave of the torque, what the same model "
      "fitted to these logs leaves, and the noise floor, an estimate of what would be left if anything that depends on "
      "the motion were known. The figures leave out rows near velocity reversals; the search uses them but for what "
      "friction does there. All that follows speaks of the fitted model.");
  Table table({text_column("drive"), "parameters as given", "fitted", "noise floor",
               "share of the residual that follows the motion", "chance of that by noise",
               text_column("residual follows")});
  for (std::size_t j = 0; j < d.drives.size(); ++j) {
    const DriveFit& drive = d.drives[j];
    const char* unit = units_of(robot, static_cast<int>(j)).torque;
    const bool fits = drive.structure < 0.12;
    std::vector<std::string> follows;
    for (std::size_t k = 0; k < std::min<std::size_t>(2, drive.follows.size()) && !fits; ++k)
      follows.push_back(drive.follows[k].first);
    table.row({std::to_string(j + 1), format_number(drive.rms_given, unit, 3), format_number(drive.rms, unit, 3),
               format_number(drive.floor, unit, 3), format_percent(drive.structure), p_text(drive.p_value),
               fmt::format("{}", fmt::join(follows, ", "))},
              fits ? Tone::plain : Tone::caution);
  }
  report.table(table);
}

void step_2(HtmlReport& report, const Diagnosis& d, const Robot& robot) {
  report.heading("2. Where does it fail?");
  report.paragraph(
      "Mean residual of the training logs over speed, position and time of the drives concerned. Where the model is "
      "right, two of three bars (one standard error) cross zero; a curve is physics that the model lacks.");
  for (const int j : drives_to_show(d)) {
    const std::string name = "drive " + std::to_string(j + 1), unit = units_of(robot, j).position;
    report.plot(map_of(d, robot, j, "rate of " + name + " [" + unit + "/s]", name + ": residual over its rate",
                       [](const DiagnosisTrace& trace, Index k, int drive) { return trace.qd(k, drive); }));
    report.plot(map_of(d, robot, j, "position of " + name + " [" + unit + "]", name + ": residual over its position",
                       [](const DiagnosisTrace& trace, Index k, int drive) { return trace.q(k, drive); }));
    report.plot(map_of(d, robot, j, "time in the log [s]", name + ": residual over time",
                       [](const DiagnosisTrace& trace, Index k, int) { return trace.t_s(k); }));
  }
}

void step_3(HtmlReport& report, const Diagnosis& d) {
  report.heading("3. What could it be?");
  std::vector<const ConsideredEffect*> order;
  for (const ConsideredEffect& one : d.considered) order.push_back(&one);
  std::ranges::sort(order, std::greater(), &ConsideredEffect::gain_alone);
  report.paragraph(fmt::format(
      "{} effects at their places were tried. Each counts by what a re-fit of all parameters cannot absorb, with the "
      "sign that physics allows, against {} simulated logs of this motion that miss nothing.",
      d.considered.size(), d.null_runs));
  const auto fill = [](Table& table, const ConsideredEffect& one) {
    const Tone tone = one.ruling == Ruling::found         ? Tone::strong
                      : one.ruling == Ruling::no_evidence ? Tone::muted
                                                          : Tone::plain;
    table.row({one.name, one.joint, one.effect_class, format_number(one.gain_alone, 4), p_text(one.p_alone),
               p_text(one.p_left), ruling_text(one)},
              tone);
  };
  const std::vector<TableColumn> columns = {text_column("effect"), text_column("at"), text_column("class"),
                                            "explains [chi²]",     "chance alone",    "chance beside the found",
                                            text_column("ruling")};
  Table top(columns);
  for (std::size_t k = 0; k < std::min<std::size_t>(12, order.size()); ++k) fill(top, *order[k]);
  report.table(top, "The twelve that explain most of the residual, each alone.");
  report.details("All effects considered", [&](HtmlReport& inner) {
    Table all(columns);
    for (const ConsideredEffect* one : order) fill(all, *one);
    inner.table(all);
  });
  report.details("What these logs can show and tell apart (from the motion, before any torque is looked at)",
                 [&](HtmlReport& inner) {
                   inner.paragraph(
                       "Visible: share of the effect's torque that a re-fit of all other parameters cannot absorb. "
                       "Smallest size: the amplitude that would be named at the noise of these logs. Hardly told from: "
                       "effects whose torques are alike in these motions, with the cosine between them.");
                   Table table({text_column("effect"), text_column("at"), "visible", "smallest size",
                                text_column("hardly told from")});
                   for (const ConsideredEffect& one : d.considered) {
                     table.row({one.name, one.joint, format_percent(one.kept, 2),
                                format_number(one.detectable, pretty_unit(one.unit), 3),
                                fmt::format("{}", fmt::join(one.like, "; "))},
                               one.kept < 0.002 ? Tone::muted : Tone::plain);
                   }
                   inner.table(table);
                 });
}

void step_4(HtmlReport& report, const Diagnosis& d, const Robot& robot, const DiagnosisText& text) {
  report.heading("4. What is it, and how large?");
  if (d.named.empty()) {
    report.paragraph(text.headline);
    return;
  }
  for (const NamedEffect& one : d.named) {
    const EffectKind& kind = effect_kind(one.effect.id);
    report.subheading(one.at_joint());
    report.paragraph(fmt::format("In words: {}. It acts at {}.", kind.meaning, region_text(robot, one)));
    Table table({text_column("parameter"), "value ± standard deviation", "95 % interval"});
    const auto add = [&](const auto& traits, double value, double std) {
      const std::string unit = pretty_unit(effect_unit(traits.unit, one.effect.joint, robot.description()));
      const bool choice = !std::isfinite(std);
      table.row({std::string(traits.name),
                 choice ? format_number(value, unit) : format_with_uncertainty(value, std, unit),
                 choice ? "the best of a few choices" : format_interval(value - 1.96 * std, value + 1.96 * std, unit)});
    };
    for (std::size_t k = 0; k < kind.amplitudes.size(); ++k) {
      const auto at = static_cast<Index>(k);
      add(kind.amplitudes[k], one.effect.amplitude(at),
          one.effect.amplitude_std.size() > at ? one.effect.amplitude_std(at) : 0);
    }
    for (std::size_t k = kind.tied ? 1 : 0; k < kind.shapes.size(); ++k) {
      const auto at = static_cast<Index>(k);
      add(kind.shapes[k], one.effect.shape(at),
          one.effect.shape_std.size() > at ? one.effect.shape_std(at) : std::nan(""));
    }
    report.table(table);
    report.note(
        "The intervals hold what the noise leaves open and, as no machine follows the catalogue's law exactly, a "
        "standard deviation of 1 % of the size, 3 % for laws of friction and phase, 6 % for losses that grow with the "
        "load, 15 % for the spring in a drive.");
    report.note(fmt::format("Chance of this on logs that miss nothing: {}. It explains {} of the structure.",
                            p_text(one.p_value), format_percent(one.explained_share)));
    if (one.objection != Objection::none) {
      report.paragraph("Not added to the model: " + objection_text(one) + ".");
    } else if (one.confusable.empty()) {
      report.paragraph("Nothing else in the catalogue explains it as well.");
    } else {
      std::vector<std::string> items;
      for (const EffectCandidate& other : one.confusable)
        items.push_back(other.at_joint() + ": " + set_text(one, other));
      report.paragraph("It could also be:");
      report.list(items);
    }
  }
}

void step_5(HtmlReport& report, const Diagnosis& d, const Robot& robot) {
  report.heading("5. Does it hold on a log that took no part?");
  const auto held = std::ranges::find(d.traces, true, &DiagnosisTrace::holdout);
  if (held == d.traces.end()) {
    report.paragraph("There was no hold-out log (--holdout), so nothing can be proven.");
    return;
  }
  if (!d.named.empty()) {
    Table table({text_column("effect"), "residual before", "after", "floor"});
    for (const NamedEffect& one : d.named) {
      const char* unit = units_of(robot, one.drives.empty() ? 0 : one.drives.front()).torque;
      table.row({one.at_joint(), format_number(one.rms_before, unit, 3), format_number(one.rms_after, unit, 3),
                 format_number(one.rms_floor, unit, 3)});
    }
    report.table(table, "Root mean square residual of the drives that the effect reaches, on " + held->file + ".");
    report.paragraph(gap_text(d));
  } else {
    Table table({text_column("drive"), "residual", "floor"});
    for (std::size_t j = 0; j < d.drives.size(); ++j) {
      const char* unit = units_of(robot, static_cast<int>(j)).torque;
      table.row({std::to_string(j + 1), format_number(d.drives[j].rms_holdout, unit, 3),
                 format_number(d.drives[j].floor_holdout, unit, 3)});
    }
    report.table(table, "Root mean square residual of the model fitted to the training logs, on " + held->file + ".");
  }
  for (const int j : drives_to_show(d)) {
    const Index step = std::max<Index>(1, held->t_s.size() / kMostPoints);
    const VectorXd t = thinned(held->t_s, step);
    const bool changed = !d.named.empty();
    const auto panel = [&](const char* title, const char* quantity) {
      return PlotSpec{.title = fmt::format("Drive {}: {}", j + 1, title),
                      .x_label = "time [s]",
                      .y_label = fmt::format("{} [{}]", quantity, units_of(robot, j).torque),
                      .height = 240};
    };
    PlotSpec torque = panel("torque on the hold-out log", "torque"), residual = panel("residual", "residual");
    const auto add = [&t, step](PlotSpec& plot, const char* label, const VectorXd& y, PlotColor color,
                                bool dashed = false) {
      plot.series.push_back({label, t, thinned(y, step), SeriesStyle::line, {}, color, dashed});
    };
    add(torque, "measured", held->torque.col(j), PlotColor::grey);
    add(torque, changed ? "model before" : "model", held->torque.col(j) - held->before.col(j), PlotColor::vermillion);
    if (changed) add(torque, "model after", held->torque.col(j) - held->after.col(j), PlotColor::blue, true);
    VectorXd before = held->before.col(j), after = held->after.col(j);
    for (Index k = 0; k < before.size(); ++k) {
      if (!held->usable(k, j)) before(k) = after(k) = std::nan("");  // near reversals nothing is claimed
    }
    add(residual, changed ? "before" : "model", before, PlotColor::vermillion);
    if (changed) add(residual, "after", after, PlotColor::blue);
    report.plot({torque, residual});
  }
}

}  // namespace

std::string diagnosis_report(const Robot& robot, const Diagnosis& d, const ReportContext& context) {
  HtmlReport report("What is the model missing?", context.robot_file);
  const DiagnosisText text = diagnosis_text(robot, d);
  std::vector<std::string> lines = text.lines;
  for (const std::string& next : text.next) lines.push_back("Next: " + next);
  report.verdict(verdict_of(d), text.headline, lines);
  add_log_check(report, context.findings);
  std::vector<KeyFigure> figures = {{"verdict", verdict_name(d.verdict)}};
  if (!d.named.empty()) {
    figures.push_back({"effect", d.named.front().name, "at " + d.named.front().joint});
    figures.push_back({"chance of so strong a sign on clean logs", p_text(d.named.front().p_value)});
    if (shows_gap(d)) {
      figures.push_back({"gap closed on the hold-out log", fmt::format("{:.1f} %", 100 * d.gap_shrink),
                         fmt::format("{:.1f} to {:.1f} %", 100 * d.gap_low, 100 * d.gap_high)});
    }
  }
  report.key_figures(figures);
  if (!d.drives.empty()) {
    step_1(report, d, robot);
    step_2(report, d, robot);
    step_3(report, d);
    step_4(report, d, robot, text);
    step_5(report, d, robot);
  }
  report.heading("6. What to do next");
  report.list(text.next);
  if (!text.notes.empty()) report.list(text.notes);
  report.heading("How this was done");
  Facts facts = {{"robot", context.robot_file}, {"model", context.parameter_file}};
  for (const std::string& file : context.log_files) facts.emplace_back("training log", file);
  for (const DiagnosisTrace& trace : d.traces) {
    if (trace.holdout) facts.emplace_back("hold-out log", trace.file);
  }
  if (!d.drives.empty()) {
    facts.emplace_back("cut-off of the motion", format_number(d.cutoff_hz, "Hz"));
    facts.emplace_back("simulated clean logs", std::to_string(d.null_runs));
    facts.emplace_back("share of the residual that encoder noise makes", format_percent(d.encoder_share));
  }
  facts.emplace_back("time", format_duration(d.total_time_s));
  report.facts(facts);
  report.footer(context.command_line);
  return report.str();
}

}  // namespace deltadyn
