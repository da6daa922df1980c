#include "drive_figures.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <numeric>

#include "deltadyn/report/format.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/signal/spectrum.hpp"

#include "assessment_limits.hpp"
#include "assessment_parts.hpp"
#include "drive_names.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kLogsShown = 3;   // keeps a report on many logs small; all of them count in the tables
constexpr double kShown_s = 20;         // longer pieces of a torque curve cannot be read at the width of a page
constexpr Index kPointsShown = 1200;    // of a scatter plot: 80 bytes each
constexpr double kEndOfSpectrum = 1.1;  // in units of the low pass of the torque
constexpr Index kIntervals = 24;        // as in residual_structure()

/// Residual with the rows of other use left out (NaN).
Eigen::VectorXd masked_residual(const Prediction& prediction, int drive, bool regular, bool reversal) {
  Eigen::VectorXd e = prediction.tau.col(drive) - prediction.model.col(drive);
  for (Index k = 0; k < e.size(); ++k) {
    const RowUse use = prediction.use(k, drive);
    if (!((use == RowUse::regular && regular) || (use == RowUse::reversal && reversal))) e(k) = kNaN;
  }
  return e;
}

struct Rows {
  Index first, count;
};

/// The piece of a log that is shown: all of it, or where the residual is largest.
Rows shown_rows(const Validation& validation, const ValidatedLog& log) {
  const Prediction& p = log.prediction;
  const Index all = p.rows();
  const auto length = static_cast<Index>(std::max(2.0, kShown_s * log.row_rate_hz));
  if (all <= length + length / 4) return {0, all};
  Eigen::VectorXd square = Eigen::VectorXd::Zero(all);
  for (std::size_t j = 0; j < validation.drives.size(); ++j) {
    const Eigen::ArrayXd e = masked_residual(p, static_cast<int>(j), true, false).array() /
                             std::max(validation.drives[j].rms_residual, 1e-300);
    square += e.isNaN().select(0.0, e.square()).matrix();
  }
  double sum = square.head(length).sum(), best = sum;
  Index first = 0;
  for (Index k = 1; k + length <= all; ++k) {
    sum += square(k + length - 1) - square(k - 1);
    if (sum > best) {
      best = sum;
      first = k;
    }
  }
  return {first, length};
}

PlotRange symmetric_range(double largest) {
  const double half = largest > 0 ? 1.15 * largest : 1.0;
  return {-half, half};
}

double largest_finite(const Eigen::VectorXd& values) {
  const Eigen::ArrayXd a = values.array().abs();
  return a.size() == 0 ? 0.0 : a.isFinite().select(a, 0.0).maxCoeff();
}

/// Panels of drives that share an axis: all limbs, then the drive of the telescope, whose speeds are of another size.
std::vector<std::vector<int>> drives_of_like_kind(const Robot& robot) {
  std::vector<std::vector<int>> groups(1);
  const auto limbs = static_cast<int>(robot.description().limbs.size());
  for (int j = 0; j < robot.drives(); ++j) {
    if (j == limbs) groups.emplace_back();
    groups.back().push_back(j);
  }
  return groups;
}

std::string name_of_group(const std::vector<int>& drives) {
  return drives.size() == 1 ? drive_name(drives.front())
                            : fmt::format("drives {} to {}", drives.front() + 1, drives.back() + 1);
}

/// Means over intervals of equally many rows, with the interval that holds them at 95 %.
Series interval_means(const Eigen::VectorXd& x, const Eigen::VectorXd& e, double correlation) {
  std::vector<Index> order(static_cast<std::size_t>(x.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::stable_sort(order, [&](Index a, Index b) { return x(a) < x(b); });
  const Index intervals = std::max<Index>(1, std::min<Index>(kIntervals, x.size() / 8));
  Series means{"mean, ± 95 %",         Eigen::VectorXd(intervals), Eigen::VectorXd(intervals),
               SeriesStyle::errorbars, Eigen::VectorXd(intervals), PlotColor::vermillion};
  for (Index k = 0; k < intervals; ++k) {
    const Index from = k * x.size() / intervals, to = (k + 1) * x.size() / intervals;
    double sum_x = 0, sum = 0, square = 0;
    for (Index i = from; i < to; ++i) {
      const Index row = order[static_cast<std::size_t>(i)];
      sum_x += x(row);
      sum += e(row);
      square += e(row) * e(row);
    }
    const auto count = static_cast<double>(std::max<Index>(1, to - from));
    means.x(k) = sum_x / count;
    means.y(k) = sum / count;
    means.y_error(k) =
        1.96 * std::sqrt(std::max(0.0, square / count - means.y(k) * means.y(k)) * std::max(1.0, correlation) / count);
  }
  return means;
}

}  // namespace

std::string short_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

void add_torque_figures(HtmlReport& report, const Robot& robot, const Validation& validation) {
  const std::size_t shown = std::min(kLogsShown, validation.logs.size());
  for (std::size_t l = 0; l < shown; ++l) {
    const ValidatedLog& log = validation.logs[l];
    const Prediction& p = log.prediction;
    const Rows rows = shown_rows(validation, log);
    const Eigen::VectorXd t = p.t_s.segment(rows.first, rows.count);
    const auto piece = [&](const Eigen::VectorXd& all) { return Eigen::VectorXd(all.segment(rows.first, rows.count)); };
    std::vector<PlotSpec> panels;
    bool grey = false, cut_off = false;
    for (int j = 0; j < robot.drives(); ++j) {
      panels.push_back(
          {.title = fmt::format("Drive {}", j + 1),
           .x_label = "time [s]",
           .y_label = fmt::format("{} [{}]", units_of(robot, j).effort, units_of(robot, j).torque),
           .series = {{"measured", t, piece(p.tau.col(j)), SeriesStyle::line, {}, PlotColor::blue},
                      {"model", t, piece(p.model.col(j)), SeriesStyle::line, {}, PlotColor::vermillion, true}},
           .height = 210});
      PlotSpec rest{
          .x_label = "time [s]", .y_label = fmt::format("residual [{}]", units_of(robot, j).torque), .height = 150};
      const Eigen::VectorXd regular = piece(masked_residual(p, j, true, false)),
                            reversal = piece(masked_residual(p, j, false, true));
      if (reversal.array().isFinite().any()) {
        grey = true;
        rest.series.push_back({"", t, reversal, SeriesStyle::line, {}, PlotColor::grey});
      }
      rest.series.push_back({"", t, regular, SeriesStyle::line, {}, PlotColor::green});
      // The rows that count set the scale: spikes at reversals would flatten everything else.
      const double largest = largest_finite(regular);
      rest.y_range = symmetric_range(largest > 0 ? std::min(2 * largest, std::max(largest, largest_finite(reversal)))
                                                 : largest_finite(reversal));
      cut_off = cut_off || largest_finite(reversal) > rest.y_range->high;
      panels.push_back(std::move(rest));
    }
    std::string caption =
        fmt::format("{}: measured and model {} with the residual below (measured minus model, filtered alike).",
                    short_name(log.file), units_of(robot, 0).effort);
    if (grey)
      caption +=
          fmt::format(" Grey: near velocity reversals{}.", cut_off ? ", where spikes are cut off at the edge" : "");
    if (rows.count < p.rows()) {
      caption += fmt::format(" Shown are the {} with the largest residual of {}.",
                             format_duration(t(t.size() - 1) - t(0)), format_duration(p.t_s(p.rows() - 1) - p.t_s(0)));
    }
    report.plot(panels, caption);
  }
  if (shown < validation.logs.size()) {
    report.note(fmt::format("The first {} of {} logs are drawn; the figures count all of them.", shown,
                            validation.logs.size()));
  }
}

void add_residual_spectra(HtmlReport& report, const Robot& robot, const Validation& validation) {
  constexpr PlotColor kColors[] = {PlotColor::blue, PlotColor::vermillion, PlotColor::green};
  std::vector<PlotSpec> panels;
  for (int j = 0; j < robot.drives(); ++j) {
    PlotSpec spec{.title = fmt::format("Drive {}", j + 1),
                  .x_label = "frequency [Hz]",
                  .y_label = turns(robot, j) ? "[(N m)²/Hz]" : "[N²/Hz]",
                  .log_y = true,
                  .height = 175};
    for (std::size_t l = 0; l < std::min(kLogsShown, validation.logs.size()); ++l) {
      const ValidatedLog& log = validation.logs[l];
      const Eigen::VectorXd residual = masked_residual(log.prediction, j, true, true);
      try {
        const PowerSpectrum spectrum = welch_spectrum(residual, log.row_rate_hz);
        // The first bin has lost its mean; beyond the low pass there is nothing left to see.
        const double end = validation.processing.filter ? kEndOfSpectrum * validation.processing.torque_cutoff_ratio *
                                                              validation.processing.cutoff_hz
                                                        : std::numeric_limits<double>::infinity();
        const Index bins = std::max<Index>(2, (spectrum.frequency_hz.array() <= end).count() - 1);
        spec.series.push_back({.label = validation.logs.size() > 1 ? short_name(log.file) : "",
                               .x = spectrum.frequency_hz.segment(1, bins),
                               .y = spectrum.density.segment(1, bins),
                               .color = kColors[l]});
      } catch (const Error&) {
        continue;  // too short a log, or no stretch without repaired samples: nothing to draw
      }
    }
    if (validation.processing.filter && !spec.series.empty())
      spec.vertical_markers.push_back({validation.processing.cutoff_hz, j == 0 ? "cut-off of the motion" : ""});
    const bool flat = std::ranges::all_of(spec.series, [](const Series& s) { return !(s.y.maxCoeff() > 0); });
    if (!spec.series.empty() && !flat) panels.push_back(std::move(spec));
  }
  if (panels.empty()) {
    report.note("The logs are too short for a spectrum.");
    return;
  }
  report.plot(
      panels,
      "Power spectrum of the residual (Welch; rows near velocity reversals included). Noise is flat up to the low "
      "pass; what stands out at low frequencies follows the motion, a narrow peak is a resonance or a ripple.");
}

void add_residual_over(HtmlReport& report, const Robot& robot, const Validation& validation, Coordinate coordinate) {
  const bool velocity = coordinate == Coordinate::velocity;
  const std::vector<ResidualStructure> structure = residual_structure(validation);
  for (const std::vector<int>& group : drives_of_like_kind(robot)) {
    std::vector<PlotSpec> panels;
    for (const int j : group) {
      std::vector<double> x, e;
      for (const ValidatedLog& log : validation.logs) {
        const Prediction& p = log.prediction;
        for (Index k = 0; k < p.rows(); ++k) {
          if (p.use(k, j) != RowUse::regular) continue;
          x.push_back(velocity ? p.qd(k, j) : p.q(k, j));
          e.push_back(p.tau(k, j) - p.model(k, j));
        }
      }
      if (x.empty()) continue;
      const Eigen::VectorXd X = Eigen::Map<Eigen::VectorXd>(x.data(), static_cast<Index>(x.size()));
      const Eigen::VectorXd E = Eigen::Map<Eigen::VectorXd>(e.data(), static_cast<Index>(e.size()));
      const Index step = std::max<Index>(1, (X.size() + kPointsShown - 1) / kPointsShown),
                  points = (X.size() + step - 1) / step;
      const auto shown = Eigen::seqN(0, points, step);
      panels.push_back({.title = fmt::format("Drive {}", j + 1),
                        .x_label = velocity ? fmt::format("velocity [{}]", units_of(robot, j).velocity)
                                            : fmt::format("position [{}]", units_of(robot, j).position),
                        .y_label = fmt::format("residual [{}]", units_of(robot, j).torque),
                        .series = {{"one row", X(shown), E(shown), SeriesStyle::points, {}, PlotColor::grey},
                                   interval_means(X, E, structure[static_cast<std::size_t>(j)].correlation)},
                        .horizontal_markers = {{0.0, ""}},
                        .height = 180});
    }
    if (panels.empty()) continue;
    report.plot(
        panels,
        fmt::format("Residual over {}, {}; without the rows that are left out near velocity reversals. {}",
                    velocity ? "velocity" : "position", name_of_group(group),
                    velocity ? "Means that leave zero show friction that Coulomb and viscous friction do not describe."
                             : "Means that leave zero show springs, cables, unbalance, gear ripple or wrong lengths."));
  }
}

void add_structure_table(HtmlReport& report, const std::vector<ResidualStructure>& residual) {
  Table table({text_column("drive"), "velocity", "position", "acceleration", "memory [rows]", text_column("reading")});
  const auto cell = [](const DependenceOnMotion& d) {
    return d.p_value > kRareByChance ? std::string("by chance") : fmt::format("{:.0f} %", 100 * d.share);
  };
  for (std::size_t j = 0; j < residual.size(); ++j) {
    const ResidualStructure& r = residual[j];
    DependenceOnMotion found;
    const std::string coordinate = worst_dependence(r, found);
    const bool memory = r.correlation > kNoticeableMemory;
    const std::string reading = !coordinate.empty() ? meaning_of_dependence(coordinate)
                                : memory            ? "slow waves, not of this drive's motion"
                                                    : "like noise";
    table.row({drive_name(static_cast<int>(j)), cell(r.on_velocity), cell(r.on_position), cell(r.on_acceleration),
               fmt::format("{:.1f}", r.correlation), reading},
              coordinate.empty() && !memory ? Tone::plain : Tone::caution);
  }
  report.table(table,
               "Share of the residual's mean square that follows the motion of its own drive, chance taken out, and "
               "its memory: rows that tell as much as one of white noise.");
}

void add_motion_table(HtmlReport& report, const Robot& robot, const Validation& validation) {
  Table table({text_column("drive"), "position", "largest velocity", "largest acceleration",
               fmt::format("largest {}", units_of(robot, 0).effort)});
  for (int j = 0; j < robot.drives(); ++j) {
    double low = std::numeric_limits<double>::infinity(), high = -low, velocity = 0, acceleration = 0, torque = 0;
    for (const ValidatedLog& log : validation.logs) {
      const Prediction& p = log.prediction;
      if (p.rows() == 0) continue;
      low = std::min(low, p.q.col(j).minCoeff());
      high = std::max(high, p.q.col(j).maxCoeff());
      velocity = std::max(velocity, p.qd.col(j).cwiseAbs().maxCoeff());
      acceleration = std::max(acceleration, p.qdd.col(j).cwiseAbs().maxCoeff());
      torque = std::max(torque, p.tau.col(j).cwiseAbs().maxCoeff());
    }
    table.row({drive_name(j), fmt::format("{:.3f} … {:.3f} {}", low, high, units_of(robot, j).position),
               format_number(velocity, units_of(robot, j).velocity, 3),
               format_number(acceleration, units_of(robot, j).acceleration, 3),
               format_number(torque, units_of(robot, j).torque, 3)});
  }
  report.table(table, "Where the logs went. Beyond these values the model is an extrapolation.");
}

void add_check_table(HtmlReport& report, const Assessment& assessment) {
  Table table(
      {TableColumn("", Align::center), text_column("question"), text_column("finding"), text_column("meaning")});
  for (const Check& check : assessment.checks) {
    const auto [mark, tone] = check.verdict == Verdict::good  ? std::pair("✓", Tone::plain)
                              : check.verdict == Verdict::bad ? std::pair("✗", Tone::bad)
                                                              : std::pair("!", Tone::caution);
    table.row({mark, check.subject, check.figure, check.meaning}, tone);
  }
  report.table(table);
}

Facts source_facts(const ReportContext& context, const std::string& model, const std::string& model_file,
                   const Validation& validation) {
  const ProcessingOptions& options = validation.processing;
  Facts facts = {{"Robot file", context.robot_file}, {model, model_file}};
  for (const std::string& file : context.log_files) facts.emplace_back("Log", file);
  if (!options.filter) {
    facts.emplace_back("Filter", "none: torque, positions, velocities and accelerations as in the log");
  } else {
    facts.emplace_back("Cut-off of the motion",
                       fmt::format("{} (zero phase, -3 dB)", format_number(options.cutoff_hz, "Hz", 3)));
    facts.emplace_back("Cut-off of torque and regressor",
                       fmt::format("{} (the same linear-phase low pass, -6 dB)",
                                   format_number(options.torque_cutoff_ratio * options.cutoff_hz, "Hz", 3)));
  }
  for (const ValidatedLog& log : validation.logs) {
    facts.emplace_back(
        short_name(log.file),
        fmt::format("{} samples at {}, {} rows at {}", format_count(log.samples), format_number(log.rate_hz, "Hz", 4),
                    format_count(log.prediction.rows()), format_number(log.row_rate_hz, "Hz", 3)));
  }
  return facts;
}

}  // namespace deltadyn
