#include <algorithm>
#include <fmt/format.h>

#include "deltadyn/report/format.hpp"

#include "drive_names.hpp"
#include "identification_sections.hpp"

namespace deltadyn {

using Eigen::Index;

static constexpr PlotColor kCurveColors[] = {PlotColor::blue, PlotColor::green, PlotColor::orange, PlotColor::purple};

void add_cutoff_figure(HtmlReport& report, const Identification& identification) {
  if (!identification.cutoff) return;
  PlotSpec spec{.x_label = "frequency [Hz]",
                .y_label = "position / encoder noise, power",
                .log_x = true,
                .log_y = true,
                .horizontal_markers = {{1.0, "noise"}},
                .height = 260};
  // Of each drive the log in which its motion reaches highest.
  const auto& logs = identification.cutoff->bands;
  for (std::size_t j = 0; j < logs.front().size(); ++j) {
    const auto fastest =
        std::ranges::max_element(logs, [j](const auto& a, const auto& b) { return a[j].top_hz < b[j].top_hz; });
    const MotionBand& band = (*fastest)[j];
    if (!(band.noise_density > 0)) continue;
    spec.series.push_back({.label = drive_name(static_cast<int>(j)),
                           .x = band.frequency_hz,
                           .y = band.density / band.noise_density,
                           .color = kCurveColors[j % std::size(kCurveColors)]});
  }
  if (spec.series.empty()) return;
  spec.vertical_markers.push_back(
      {identification.processing.cutoff_hz,
       fmt::format("chosen: {}", format_number(identification.processing.cutoff_hz, "Hz", 3))});
  report.plot(spec, fmt::format("Choice of the cut-off: spectrum of the positions over that of the encoders' noise, of "
                                "each drive in its fastest log. The motion has its accelerations below {}; "
                                "accelerations from it stay below the noise of the torques up to {}.",
                                format_number(identification.cutoff->band_hz, "Hz", 3),
                                format_number(identification.cutoff->noise_limit_hz, "Hz", 3)));
}

void add_regularization_figure(HtmlReport& report, const ConsistentFitSummary& fit) {
  constexpr std::size_t kFewestPoints = 3;  // a curve needs more than two points
  if (!fit.lambda_from_data || fit.l_curve.size() < kFewestPoints) {
    report.note(fmt::format("Weight of the prior λ = {}, {}.", format_number(fit.lambda, 3),
                            fit.lambda_from_data ? "chosen from the data" : "as given"));
    return;
  }
  const auto count = static_cast<Index>(fit.l_curve.size());
  Eigen::VectorXd lambda(count), rise(count), distance(count);
  for (Index k = 0; k < count; ++k) {
    const LCurvePoint& point = fit.l_curve[static_cast<std::size_t>(k)];
    lambda(k) = point.lambda;
    rise(k) = point.data_cost - fit.data_cost_min;
    distance(k) = point.regularization_cost;
  }
  // Rises far below what any data could tell stand on rounding and would stretch the axis.
  constexpr double kSmallestRise = 1e-6;
  rise = rise.cwiseMax(kSmallestRise);
  const auto panel = [&](const std::string& y_label, const Eigen::VectorXd& y, PlotColor color) {
    return PlotSpec{
        .x_label = "weight of the prior λ",
        .y_label = y_label,
        .series = {{"", lambda, y, SeriesStyle::line, {}, color}, {"", lambda, y, SeriesStyle::points, {}, color}},
        .log_x = true,
        .log_y = y.minCoeff() > 0,
        .height = 180};
  };
  std::vector<PlotSpec> panels = {panel("rise of χ²", rise, PlotColor::blue),
                                  panel("distance from prior", distance, PlotColor::orange)};
  panels[0].vertical_markers.push_back({fit.lambda, fmt::format("chosen: λ = {}", format_number(fit.lambda, 3))});
  panels[1].vertical_markers.push_back({fit.lambda, ""});
  report.plot(panels,
              fmt::format("Choice of the regularisation: the largest weight of the prior that the data do not feel. At "
                          "the chosen one χ² is {} above its minimum on the physically consistent set.",
                          format_number(std::max(0.0, fit.data_cost - fit.data_cost_min), 2)));
}

void add_mass_matrix(HtmlReport& report, const Robot& robot, const MassMatrixSurvey& survey) {
  const char* unit = inertia_unit_of(robot);
  const std::string poses = format_count(survey.states);
  if (robot.description().parts.empty()) {
    report.paragraph(fmt::format("Moving inertia of the axis: {}.", format_number(survey.max_eigenvalue, unit)));
    return;
  }
  report.paragraph(
      fmt::format("{} at {} random poses of the workspace. Eigenvalues from {} to {}; worst condition number {}. "
                  "Smallest eigenvalue at x {:.3f}, y {:.3f}, z {:.3f} m.",
                  survey.positive_definite() ? "Positive definite" : "NOT positive definite everywhere, checked", poses,
                  format_number(survey.min_eigenvalue, 3), format_number(survey.max_eigenvalue, unit, 3),
                  format_number(survey.worst_condition, 3), survey.z_min(0), survey.z_min(1), survey.z_min(2)));
  constexpr Index kEigenvaluesShown = 700;  // of each eigenvalue; a point takes 80 bytes
  const Index points = std::min(survey.task.rows(), kEigenvaluesShown);
  PlotSpec spec{.x_label = "height of the plate z [m]",
                .y_label = fmt::format("eigenvalues of M [{}]", unit),
                .log_y = survey.eigenvalues.topRows(points).minCoeff() > 0,
                .height = 300};
  for (Index i = 0; i < survey.eigenvalues.cols(); ++i) {
    const char* label = i == 0 ? "smallest" : i + 1 == survey.eigenvalues.cols() ? "largest" : "";
    spec.series.push_back({.label = label,
                           .x = survey.task.col(2).head(points),
                           .y = survey.eigenvalues.col(i).head(points),
                           .style = SeriesStyle::points,
                           .color = kCurveColors[static_cast<std::size_t>(i) % std::size(kCurveColors)]});
  }
  if (!spec.log_y) spec.horizontal_markers.push_back({0.0, ""});
  report.plot(spec,
              "Eigenvalues of the mass matrix over the workspace. Where one falls to zero, the model has no inverse.");
}

}  // namespace deltadyn
