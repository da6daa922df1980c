#pragma once

/// \file
/// Plots of a report: what to draw, and drawing it as SVG or PNG. Drawn by gnuplot in a child process that reads
/// everything from its standard input; no temporary file, no shell.

#include <Eigen/Core>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace deltadyn {

/// Colours that readers with any colour vision tell apart (after Okabe and Ito), dark enough for white paper.
enum class PlotColor { blue, vermillion, green, purple, orange, sky, black, grey };

enum class SeriesStyle {
  line,
  points,
  impulses,   ///< a vertical stroke from zero to each point
  steps,      ///< each value holds until the next x
  errorbars,  ///< points with a bar from y - y_error to y + y_error
};

/// One curve. Samples with a NaN or infinite value are gaps: nothing is drawn there, and a line is interrupted.
struct Series {
  std::string label;  ///< text in the legend; empty: not in the legend
  Eigen::VectorXd x;  ///< N values, in the unit of the x axis
  Eigen::VectorXd y;  ///< N values, in the unit of the y axis
  SeriesStyle style = SeriesStyle::line;
  Eigen::VectorXd y_error = {};         ///< N half-lengths of the bars (style errorbars), else empty
  std::optional<PlotColor> color = {};  ///< chosen by the position in the plot if not given
  bool dashed = false;
};

/// A straight line across the whole plot with a label at its end, e.g. a limit or a cut-off frequency.
struct PlotMarker {
  double at = 0.0;    ///< position on the axis it is perpendicular to, in that axis' unit
  std::string label;  ///< may be empty
};

struct PlotRange {
  double low = 0.0;
  double high = 1.0;

  /// Of a value on an axis with this range: 0 at its lower end, 1 at the upper one.
  [[nodiscard]] double fraction_of(double value, bool log) const {
    return log ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  }
};

/// One pair of axes.
struct PlotSpec {
  std::string title = {};
  std::string x_label = {};  ///< with unit, e.g. "time [s]"
  std::string y_label = {};  ///< with unit, e.g. "torque [N m]"
  std::vector<Series> series = {};
  bool log_x = false;  ///< values that are not positive count as gaps
  bool log_y = false;
  std::vector<PlotMarker> horizontal_markers = {};
  std::vector<PlotMarker> vertical_markers = {};
  std::optional<PlotRange> x_range = {};        ///< the data's own range if not given
  std::optional<PlotRange> y_range = {};        ///< the data's and horizontal markers' range plus a margin if not given
  std::vector<std::string> x_tick_labels = {};  ///< for categories: text at x = 0, 1, 2, ... instead of numbers
  int width = 900;                              ///< [px]
  int height = 320;                             ///< [px]
};

/// Draws one plot, or several on top of each other, e.g. one a drive. Neighbours with the same x label share the axis:
/// label and tick labels are those of the last of them, the x range encloses all of them. Those above the last give
/// the space of their own x axis back, so that the areas keep the heights they have alone. The width and log_x are
/// those of the last panel, and a panel with the same curves as the first leaves the legend to it.
/// \param id_prefix  put before every id in the SVG; plots that share one HTML page need different prefixes
/// \return an <svg> element without XML declaration that scales with the width of the page
/// \throws Error if the specification contradicts itself, gnuplot is missing, or gnuplot fails
[[nodiscard]] std::string render_svg(const std::vector<PlotSpec>& panels, std::string_view id_prefix = "plot-");

/// The same as PNG, two picture points for each pixel of the specification so that it prints sharply.
/// The file is written whole or not at all.
/// \throws Error as render_svg, and if the file cannot be written
void render_png(const std::vector<PlotSpec>& panels, const std::filesystem::path& path);

/// True if gnuplot can be started, so that a tool can say so before a long computation and not after it.
[[nodiscard]] bool gnuplot_available();

}  // namespace deltadyn
