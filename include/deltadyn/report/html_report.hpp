#pragma once

/// \file
/// A report as one HTML page that needs nothing else: no links to the outside, no script.

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "deltadyn/report/plot.hpp"

namespace deltadyn {

enum class Verdict { good, caution, bad };

/// How a row or a figure is set off.
enum class Tone { plain, good, caution, bad, muted, strong };

enum class Align { left, center, right };

struct TableColumn {
  std::string title;           ///< with unit, e.g. "value [kg]"
  Align align = Align::right;  ///< numbers right, text left

  TableColumn(const char* text) : title(text) {}
  TableColumn(std::string text, Align side = Align::right) : title(std::move(text)), align(side) {}
};
[[nodiscard]] inline TableColumn text_column(std::string title) {
  return {std::move(title), Align::left};
}

/// Rows of ready text; numbers by the functions of format.hpp.
class Table {
 public:
  explicit Table(std::vector<TableColumn> columns) : columns_(std::move(columns)) {}
  /// \throws Error if the number of cells is not that of the columns
  Table& row(std::vector<std::string> cells, Tone tone = Tone::plain);
  [[nodiscard]] bool empty() const { return rows_.empty(); }

 private:
  friend class HtmlReport;
  struct Row {
    std::vector<std::string> cells;
    Tone tone;
  };
  std::vector<TableColumn> columns_;
  std::vector<Row> rows_;
};

/// Names and values.
using Facts = std::vector<std::pair<std::string, std::string>>;

/// One large number at the top of a report.
struct KeyFigure {
  std::string label;      ///< e.g. "residual, drive 1"
  std::string value;      ///< with unit, e.g. "0.31 N m"
  std::string note = {};  ///< small print, e.g. "0.8 % of the torque"
  Tone tone = Tone::plain;
};

/// Collects the parts of a page in the order of the calls. All text is plain text: the class escapes it.
/// The same calls give the same bytes. Plots are drawn at the call and throw Error as render_svg.
class HtmlReport {
 public:
  explicit HtmlReport(std::string title, std::string subtitle = "")
      : title_(std::move(title)), subtitle_(std::move(subtitle)) {}

  /// The box that says in plain words whether the result can be trusted.
  HtmlReport& verdict(Verdict verdict, const std::string& headline, const std::vector<std::string>& lines = {});
  HtmlReport& key_figures(const std::vector<KeyFigure>& figures);
  /// A section; it also appears in the line of contents on top of the page if there are at least three.
  HtmlReport& heading(const std::string& text);
  HtmlReport& subheading(const std::string& text) { return element("h3", "", text); }
  HtmlReport& paragraph(const std::string& text) { return element("p", "", text); }
  /// Small grey text.
  HtmlReport& note(const std::string& text) { return element("p", " class=\"note\"", text); }
  HtmlReport& list(const std::vector<std::string>& items);
  HtmlReport& table(const Table& table, const std::string& caption = "");
  /// Names on the left, values on the right: what was read, with which settings.
  HtmlReport& facts(const Facts& name_and_value);
  HtmlReport& plot(const PlotSpec& spec, const std::string& caption = "") { return plot(std::vector{spec}, caption); }
  HtmlReport& plot(const std::vector<PlotSpec>& panels, const std::string& caption = "");
  /// A section that is folded away until the reader opens it (and printed open).
  /// \param content  adds the section's parts to the report it is given
  HtmlReport& details(const std::string& summary, const std::function<void(HtmlReport&)>& content);
  /// Last line of the page, e.g. the command that made it.
  HtmlReport& footer(const std::string& text);

  /// The whole page, UTF-8. It is well-formed XML, too.
  [[nodiscard]] std::string str() const;

 private:
  HtmlReport& element(std::string_view name, std::string_view attributes, std::string_view text);

  std::string title_, subtitle_, footer_;
  std::vector<std::string> headings_;
  std::string body_;
  int plots_ = 0;
  int tables_ = 0;
};

/// Text with the characters that mean something in HTML replaced; bytes that XML forbids become a question mark.
[[nodiscard]] std::string escape_html(std::string_view text);

}  // namespace deltadyn
