#include "gnuplot_script.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <span>

#include "deltadyn/report/thinning.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

// Sizes in pixels. Fixed margins, and not gnuplot's own, so that stacked panels line up.
constexpr int kLeft = 84, kRight = 18, kTopWithoutText = 12, kTextRow = 24, kBottom = 56, kBetweenPanels = 12;
constexpr int kMinArea = 40;
constexpr double kLetter = 7.2;         // mean width of a letter of the legend
constexpr double kLegendSample = 46.0;  // its piece of line and the spaces around
constexpr double kLargest = 1e300;      // gnuplot takes larger values for undefined

constexpr std::array<const char*, 8> kHexOfColor{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                 "#E69F00", "#56B4E9", "#222222", "#7F7F7F"};
// The order in which curves without a colour of their own get one.
constexpr std::array<PlotColor, 8> kOrder{PlotColor::blue,  PlotColor::vermillion, PlotColor::green, PlotColor::purple,
                                          PlotColor::black, PlotColor::orange,     PlotColor::sky,   PlotColor::grey};

/// A string for gnuplot in which nothing can end the string, run a command (`...`) or expand: every character that is
/// no letter or space is written as its octal number. Single quotes would be shorter, but gnuplot reads a doubled quote
/// at the start of a string as an empty string. Digits are written so, too, because gnuplot would add them to a number
/// in front of them.
std::string quote(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool harmless = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || byte >= 0x80;
    if (harmless)
      result += c;
    else if (byte <= 0x20 || byte == 0x7f)
      result += ' ';
    else
      result += fmt::format("\\{:03o}", byte);
  }
  return result + "\"";
}

/// The same for the text at a tick, which gnuplot takes for a format of a number.
std::string quote_format(std::string_view text) {
  std::string doubled;
  for (const char c : text) doubled += c == '%' ? "%%" : std::string(1, c);
  return quote(doubled);
}

std::size_t letters(std::string_view utf8) {
  return static_cast<std::size_t>(std::ranges::count_if(utf8, [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string where(const PlotSpec& spec) {
  return "plot \"" + spec.title + "\"";
}

void check_range(const PlotSpec& spec, const std::optional<PlotRange>& range, bool log, char axis) {
  if (!range) return;
  if (!std::isfinite(range->low) || !std::isfinite(range->high) || range->low >= range->high ||
      (log && range->low <= 0.0)) {
    throw Error(
        fmt::format("the {} range {} to {} is {}", axis, range->low, range->high,
                    log ? "not an increasing range of positive values, as a logarithmic axis needs" : "not increasing"),
        where(spec), "give a lower end below the upper end", ExitCode::usage);
  }
}

void check(const PlotSpec& spec) {
  for (const Series& series : spec.series) {
    if (series.x.size() != series.y.size()) {
      throw Error(
          fmt::format("series \"{}\" has {} x values and {} y values", series.label, series.x.size(), series.y.size()),
          where(spec), "give one y for each x", ExitCode::usage);
    }
    const bool bars = series.style == SeriesStyle::errorbars;
    if (series.y_error.size() != (bars ? series.y.size() : 0)) {
      throw Error(fmt::format("series \"{}\" has {} y values and {} bars", series.label, series.y.size(),
                              series.y_error.size()),
                  where(spec), "give one bar for each y with the style errorbars, and none with the others",
                  ExitCode::usage);
    }
  }
  check_range(spec, spec.x_range, spec.log_x, 'x');
  check_range(spec, spec.y_range, spec.log_y, 'y');
}

/// Grows over all values that can be drawn.
class Extent {
 public:
  explicit Extent(bool log) : log_(log) {}
  void add(double value) {
    if (!(std::abs(value) < kLargest) || (log_ && value <= 0.0)) return;
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
  }
  [[nodiscard]] bool empty() const { return low_ > high_; }
  /// The range with a margin on both sides (fraction of its length); never of length zero.
  [[nodiscard]] PlotRange range(double margin) const {
    if (empty()) return log_ ? PlotRange{0.1, 1.0} : PlotRange{0.0, 1.0};
    if (log_) {
      const double factor = high_ > low_ * (1.0 + 1e-9) ? std::pow(high_ / low_, margin) : 2.0;
      return {low_ / factor, high_ * factor};
    }
    const double length = high_ - low_;
    if (length > 1e-12 * std::max(std::abs(low_), std::abs(high_)))
      return {low_ - margin * length, high_ + margin * length};
    const double half = std::max(1e-3 * std::abs(high_), high_ == 0.0 ? 1.0 : 1e-300);
    return {low_ - half, high_ + half};
  }

 private:
  bool log_;
  double low_ = std::numeric_limits<double>::infinity();
  double high_ = -std::numeric_limits<double>::infinity();
};

/// Panels one below the other share the x axis as long as they call it the same.
bool shares_axis_with_next(std::span<const PlotSpec> panels, std::size_t k) {
  return k + 1 < panels.size() && panels[k].x_label == panels[k + 1].x_label;
}

/// Those that share the axis of panel k.
std::span<const PlotSpec> sharing_axis(std::span<const PlotSpec> panels, std::size_t k) {
  std::size_t first = k, last = k;
  while (first > 0 && shares_axis_with_next(panels, first - 1)) --first;
  while (shares_axis_with_next(panels, last)) ++last;
  return panels.subspan(first, last - first + 1);
}

PlotRange common_x_range(std::span<const PlotSpec> panels) {
  constexpr double kRoomForPoints = 0.02;
  const PlotSpec& last = panels.back();
  Extent extent(last.log_x);
  double margin = 0;
  for (const PlotSpec& spec : panels) {
    if (spec.x_range) {
      extent.add(spec.x_range->low);
      extent.add(spec.x_range->high);
      continue;
    }
    for (const Series& series : spec.series) {
      for (const double x : series.x) extent.add(x);
      if (series.style == SeriesStyle::points) margin = kRoomForPoints;
    }
    for (const PlotMarker& marker : spec.vertical_markers) extent.add(marker.at);
  }
  if (last.x_tick_labels.empty()) return extent.range(margin);
  extent.add(0.0);
  extent.add(static_cast<double>(last.x_tick_labels.size() - 1));
  const PlotRange range = extent.range(0.0);
  return last.x_range ? range : PlotRange{range.low - 0.5, range.high + 0.5};
}

PlotRange y_range(const PlotSpec& spec, const PlotRange& x_range) {
  if (spec.y_range) return *spec.y_range;
  Extent extent(spec.log_y);
  bool from_zero = false;
  for (const Series& series : spec.series) {
    for (Eigen::Index i = 0; i < series.y.size(); ++i) {
      if (!(series.x(i) >= x_range.low && series.x(i) <= x_range.high)) continue;
      extent.add(series.y(i));
      if (series.style == SeriesStyle::errorbars && std::isfinite(series.y_error(i))) {
        extent.add(series.y(i) - series.y_error(i));
        extent.add(series.y(i) + series.y_error(i));
      }
      from_zero = from_zero || series.style == SeriesStyle::impulses;
    }
  }
  if (from_zero) extent.add(0.0);
  for (const PlotMarker& marker : spec.horizontal_markers) extent.add(marker.at);
  return extent.range(0.05);
}

/// The space below the area. Names of categories that do not fit side by side are written slanted.
struct Foot {
  bool slanted = false;
  int height = kBottom;
};

Foot foot_of(const PlotSpec& last, int area_width) {
  std::size_t longest = 0;
  for (const std::string& text : last.x_tick_labels) longest = std::max(longest, letters(text));
  const double width = static_cast<double>(longest) * kLetter;
  Foot foot;
  foot.slanted = (width + kLetter) * static_cast<double>(last.x_tick_labels.size()) > area_width;
  if (foot.slanted) foot.height += static_cast<int>(0.6 * width);
  return foot;
}

/// True if one legend serves both panels.
bool same_legend(const PlotSpec& a, const PlotSpec& b) {
  return std::equal(a.series.begin(), a.series.end(), b.series.begin(), b.series.end(),
                    [](const Series& x, const Series& y) {
                      return x.label == y.label && x.style == y.style && x.color == y.color && x.dashed == y.dashed;
                    });
}

/// Rows of text above the area: title and legend side by side if they fit.
struct Head {
  bool title = false;
  bool beside = false;  ///< the legend stands in the title's row
  int legend_rows = 0;
  [[nodiscard]] int height() const {
    const int rows = (title ? 1 : 0) + legend_rows - (beside ? 1 : 0);
    return kTopWithoutText + (rows > 0 ? kTextRow * rows - (rows > 1 ? 0 : 4) : 0);
  }
};

Head head_of(const PlotSpec& spec, int area_width, bool with_legend) {
  Head head;
  head.title = !spec.title.empty();
  if (!with_legend) return head;
  std::size_t entries = 0, longest = 0;
  for (const Series& series : spec.series) {
    if (series.label.empty()) continue;
    ++entries;
    longest = std::max(longest, letters(series.label));
  }
  if (entries == 0) return head;
  const double entry = static_cast<double>(longest) * kLetter + kLegendSample;
  const double title = static_cast<double>(letters(spec.title)) * kLetter * 1.15;
  const auto per_row = static_cast<std::size_t>(std::max(1.0, std::floor(area_width / entry)));
  head.legend_rows = static_cast<int>((entries + per_row - 1) / per_row);
  head.beside = head.title && head.legend_rows == 1 && title + entry * static_cast<double>(entries) + 20.0 < area_width;
  return head;
}

const char* number_format(const PlotRange& range, bool log) {
  if (!log) return "%h";
  return range.low >= 0.9e-3 && range.high <= 1.1e4 ? "%g" : "10^{%T}";
}

std::string plot_style(const Series& series, const char* color) {
  static constexpr std::array<const char*, 5> kStyles{"lines linewidth 1.3", "points pointtype 7 pointsize 0.35",
                                                      "impulses linewidth 2", "steps linewidth 1.3",
                                                      "yerrorbars pointtype 7 pointsize 0.5 linewidth 1.3"};
  const bool dots = series.style == SeriesStyle::points || series.style == SeriesStyle::errorbars;
  return fmt::format("with {} linecolor rgb '{}'{}", kStyles[static_cast<std::size_t>(series.style)], color,
                     series.dashed && !dots ? " dashtype 2" : "");
}

/// Writes the commands of one panel after the other.
class ScriptWriter {
 public:
  ScriptWriter(const std::vector<PlotSpec>& panels, GnuplotScript& script) : panels_(panels), script_(script) {}

  void write() {
    const int area_width = panels_.back().width - kLeft - kRight;
    std::vector<Head> heads;
    script_.width = panels_.back().width;
    foot_ = foot_of(panels_.back(), area_width);
    for (std::size_t k = 0; k < panels_.size(); ++k) {
      const PlotSpec& spec = panels_[k];
      heads.push_back(head_of(spec, area_width, k == 0 || !same_legend(panels_.front(), spec)));
      script_.height += spec.height - (shares_axis_with_next(panels_, k) ? foot_.height - kBetweenPanels : 0);
      if (area_width < kMinArea || spec.height - heads.back().height() - foot_.height < kMinArea) {
        throw Error(fmt::format("{} x {} pixels leave no room for the axes", panels_.back().width, spec.height),
                    where(spec), "make the plot larger", ExitCode::usage);
      }
    }
    line("set multiplot");
    line("set style data lines");
    line("set border 3 linewidth 0.8 linecolor rgb '#444444'");
    line("set grid linetype 1 linewidth 0.6 linecolor rgb '#DDDDDD'");
    line("set tics nomirror scale 0.6 textcolor rgb '#222222'");
    line("set datafile missing 'NaN'");
    line("set errorbars small");
    line("set pointintervalbox 0.01");  // no white ring around the point in a bar; 0 would mean the standard ring
    int top = 0;
    for (std::size_t k = 0; k < panels_.size(); ++k) {
      const bool last = !shares_axis_with_next(panels_, k);
      const int area_top = top + heads[k].height();
      const int area_bottom = top + panels_[k].height - foot_.height;
      x_range_ = common_x_range(sharing_axis(panels_, k));
      panel(panels_[k], k, heads[k], top, area_top, area_bottom, last);
      top = area_bottom + (last ? foot_.height : kBetweenPanels);
    }
    line("unset multiplot");
  }

 private:
  void line(std::string_view text) {
    script_.body += text;
    script_.body += '\n';
  }
  [[nodiscard]] double screen_y(double pixel_from_top) const { return 1.0 - pixel_from_top / script_.height; }
  [[nodiscard]] double screen_x(double pixel) const { return pixel / script_.width; }

  /// \param last  of those that share its x axis
  void panel(const PlotSpec& spec, std::size_t number, const Head& head, int top, int area_top, int area_bottom,
             bool last) {
    const int right = script_.width - kRight;
    const PlotRange y = y_range(spec, x_range_);
    line("unset label\nunset arrow\nunset logscale");
    line(fmt::format("set lmargin at screen {:.6f}\nset rmargin at screen {:.6f}", screen_x(kLeft), screen_x(right)));
    line(fmt::format("set tmargin at screen {:.6f}\nset bmargin at screen {:.6f}", screen_y(area_top),
                     screen_y(area_bottom)));
    if (spec.log_x) line("set logscale x");
    if (spec.log_y) line("set logscale y");
    line(fmt::format("set xrange [{:.12g}:{:.12g}] noextend\nset yrange [{:.12g}:{:.12g}] noextend", x_range_.low,
                     x_range_.high, y.low, y.high));
    x_tics(spec, sharing_axis(panels_, number).back().x_tick_labels, last);
    line(fmt::format("set format y '{}'", number_format(y, spec.log_y)));
    line("set ylabel " + quote(spec.y_label) + " noenhanced textcolor rgb '#222222'");
    if (head.title) {
      line(fmt::format(
          "set label {} at screen {:.6f}, screen {:.6f} left noenhanced font title_font textcolor rgb '#111111'",
          quote(spec.title), screen_x(kLeft), screen_y(top + 16)));
    }
    if (head.legend_rows > 0) {
      const int key_top = top + (head.title && !head.beside ? kTextRow : 0) + 4;
      line(
          fmt::format("set key at screen {:.6f}, screen {:.6f} right top horizontal Left reverse noenhanced samplen "
                      "1.8 width 1 maxrows {} textcolor rgb '#222222'",
                      screen_x(right + 4), screen_y(key_top), head.legend_rows));
    } else {
      line("unset key");
    }
    markers(spec, y);
    curves(spec, number, PlotFrame{x_range_, y, spec.log_x, spec.log_y, right - kLeft, area_bottom - area_top});
  }

  void x_tics(const PlotSpec& spec, const std::vector<std::string>& texts, bool last) {
    line("set xlabel " + quote(last ? spec.x_label : "") + " noenhanced textcolor rgb '#222222'");
    if (texts.empty()) {
      line(fmt::format("set format x '{}'", last ? number_format(x_range_, spec.log_x) : ""));
      return;
    }
    std::string tics;
    for (std::size_t i = 0; i < texts.size(); ++i)
      tics += fmt::format("{}{} {}", i == 0 ? "" : ", ", quote_format(last ? texts[i] : ""), i);
    line(fmt::format("set xtics noenhanced {} ({})", foot_.slanted ? "rotate by 35 right" : "norotate", tics));
  }

  void markers(const PlotSpec& spec, const PlotRange& y) {
    const auto text = [&](const std::string& label, const std::string& place) {
      if (!label.empty())
        line(fmt::format("set label {} at {} noenhanced front font small_font textcolor rgb '#444444'", quote(label),
                         place));
    };
    constexpr const char* kStyle = "nohead front dashtype 4 linewidth 1 linecolor rgb '#444444'";
    for (const PlotMarker& marker : spec.horizontal_markers) {
      if (!(marker.at >= y.low && marker.at <= y.high)) continue;
      line(fmt::format("set arrow from graph 0, first {0:.12g} to graph 1, first {0:.12g} {1}", marker.at, kStyle));
      text(marker.label, fmt::format("graph 0.995, first {:.12g} right offset 0, 0.55", marker.at));
    }
    for (const PlotMarker& marker : spec.vertical_markers) {
      if (!(marker.at >= x_range_.low && marker.at <= x_range_.high)) continue;
      line(fmt::format("set arrow from first {0:.12g}, graph 0 to first {0:.12g}, graph 1 {1}", marker.at, kStyle));
      const double place = x_range_.fraction_of(marker.at, spec.log_x);
      text(marker.label, fmt::format("first {:.12g}, graph 0.95 {}", marker.at,
                                     place > 0.75 ? "right offset -0.6, 0" : "left offset 0.6, 0"));
    }
  }

  void curves(const PlotSpec& spec, std::size_t number, const PlotFrame& frame) {
    std::string commands;
    std::size_t next_color = 0;
    for (std::size_t s = 0; s < spec.series.size(); ++s) {
      const Series series = thin(spec.series[s], frame);
      const PlotColor color = series.color ? *series.color : kOrder[next_color++ % kOrder.size()];
      if (!series.y.array().isFinite().any()) continue;
      const std::string name = fmt::format("$d{}_{}", number, s);
      line(name + " << END_OF_DATA");
      const bool bars = series.style == SeriesStyle::errorbars;
      for (Eigen::Index i = 0; i < series.x.size(); ++i) {
        const bool drawable = std::abs(series.x(i)) < kLargest && std::abs(series.y(i)) < kLargest;
        if (!drawable)
          line("");  // interrupts the line
        else if (bars)
          line(fmt::format("{:.12g} {:.9g} {:.6g}", series.x(i), series.y(i), std::abs(series.y_error(i))));
        else
          line(fmt::format("{:.12g} {:.9g}", series.x(i), series.y(i)));
      }
      line("END_OF_DATA");
      commands += fmt::format("{}{} using {} {} {}", commands.empty() ? "plot " : ", ", name, bars ? "1:2:3" : "1:2",
                              series.label.empty() ? "notitle" : "title " + quote(series.label),
                              plot_style(series, kHexOfColor[static_cast<std::size_t>(color)]));
    }
    if (commands.empty()) {
      line("set label 'no data' at graph 0.5, graph 0.5 center textcolor rgb '#444444'");
      commands = "plot NaN notitle";
    }
    line(commands);
  }

  const std::vector<PlotSpec>& panels_;
  GnuplotScript& script_;
  PlotRange x_range_;
  Foot foot_;
};

}  // namespace

GnuplotScript gnuplot_script(const std::vector<PlotSpec>& panels) {
  if (panels.empty()) throw Error("a plot without panels", "", "give at least one PlotSpec", ExitCode::usage);
  for (const PlotSpec& spec : panels) {
    check(spec);
    if (spec.log_x != panels.back().log_x) {
      throw Error("panels that share the x axis mix logarithmic and linear x", where(spec),
                  "give all panels the same log_x", ExitCode::usage);
    }
  }
  GnuplotScript script;
  ScriptWriter(panels, script).write();
  return script;
}

}  // namespace deltadyn
