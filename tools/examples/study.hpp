#pragma once

/// \file
/// What the studies share: parameters by file, figures in a report and as files of their own, targets beside results.

#include <cctype>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "deltadyn/io/output_file.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/io/summary.hpp"
#include "deltadyn/report/format.hpp"
#include "deltadyn/report/html_report.hpp"
#include "deltadyn/report/plot.hpp"
#include "deltadyn/runtime/robot.hpp"

namespace deltadyn::study {

/// Parameters of a file on a robot whose layout fits them.
inline Eigen::VectorXd read_values(const Robot& robot, const std::string& file) {
  return values(read_parameters(file), robot.parameter_names(), robot.parameter_units());
}

/// A figure in the report, and beside it as SVG and PNG.
class Figures {
 public:
  Figures(HtmlReport& report, std::filesystem::path folder) : report_(report), folder_(std::move(folder)) {}

  void add(const std::string& name, const std::vector<PlotSpec>& panels, const std::string& caption) {
    write_file((folder_ / (name + ".svg")).string(), render_svg(panels) + "\n");
    render_png(panels, folder_ / (name + ".png"));
    report_.plot(panels, caption);
  }

 private:
  HtmlReport& report_;
  std::filesystem::path folder_;
};

/// One line of the closing table: the paper's figure, the one promised, the one reached.
struct Figure {
  std::string name, paper;
  double target = 0;  ///< infinite: none is set, the figure is for information
  double reached = 0;
};

/// Prints the table and adds it to the report and to the summary; true if every target is met.
inline bool conclude(const std::vector<Figure>& figures, HtmlReport& report, Summary& summary,
                     const std::string& unit) {
  Table table({{"figure", Align::left}, {"paper"}, {"target"}, {"reached"}});
  bool all = true;
  fmt::print("{:<52} {:>10} {:>10} {:>12}\n", "figure [" + unit + "]", "paper", "target", "reached");
  for (const Figure& each : figures) {
    const bool good = each.reached <= each.target, promised = std::isfinite(each.target);
    all = all && good;
    const std::string target = promised ? format_number(each.target, 3) : "-";
    table.row({each.name, each.paper, target, format_number(each.reached, 3)},
              promised ? (good ? Tone::good : Tone::bad) : Tone::plain);
    fmt::print("{:<52} {:>10} {:>10} {:>12.3g}{}\n", each.name, each.paper, target, each.reached,
               good ? "" : "  missed");
    std::string key = each.name;
    for (char& c : key) c = std::isalnum(static_cast<unsigned char>(c)) ? static_cast<char>(std::tolower(c)) : '_';
    summary.add(key, each.reached, unit == "%" ? "percent" : unit);
  }
  report.table(table, "All figures in " + unit + ".");
  return all;
}

}  // namespace deltadyn::study
