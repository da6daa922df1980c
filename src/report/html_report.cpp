#include "deltadyn/report/html_report.hpp"

#include <cctype>
#include <fmt/format.h>
#include <utility>

#include "deltadyn/io/text_encoding.hpp"
#include "deltadyn/runtime/error.hpp"

#include "html_style.hpp"

namespace deltadyn {
namespace {

const char* name_of(Tone tone) {
  static constexpr const char* kNames[] = {"plain", "good", "caution", "bad", "muted", "strong"};
  return kNames[static_cast<std::size_t>(tone)];
}

const char* name_of(Align align) {
  static constexpr const char* kNames[] = {"left", "center", "right"};
  return kNames[static_cast<std::size_t>(align)];
}

/// Class of the box and its mark: a sign besides the colour, for readers and printers without colours.
std::pair<const char*, const char*> look_of(Verdict verdict) {
  static constexpr std::pair<const char*, const char*> kLooks[] = {{"good", "✓"}, {"caution", "!"}, {"bad", "✗"}};
  return kLooks[static_cast<std::size_t>(verdict)];
}

/// Length of the UTF-8 sequence at the start of \p text that XML allows, 0 if there is none.
std::size_t valid_sequence(std::string_view text) {
  const std::size_t length = utf8_length(text);
  const bool control =
      length == 1 && std::iscntrl(static_cast<unsigned char>(text[0])) != 0 && text[0] != '\n' && text[0] != '\t';
  const bool no_character = text.starts_with("\xEF\xBF\xBE") || text.starts_with("\xEF\xBF\xBF");
  return control || no_character ? 0 : length;
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = valid_sequence(text);
    switch (length == 0 ? '?' : text[0]) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      case '\'': result += "&#39;"; break;
      default:
        if (length == 0)
          result += '?';
        else
          result += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return result;
}

Table& Table::row(std::vector<std::string> cells, Tone tone) {
  if (cells.size() != columns_.size()) {
    throw Error(fmt::format("a row of {} cells for {} columns", cells.size(), columns_.size()), "table of the report",
                "give one cell for each column", ExitCode::usage);
  }
  rows_.push_back({std::move(cells), tone});
  return *this;
}

HtmlReport& HtmlReport::element(std::string_view name, std::string_view attributes, std::string_view text) {
  body_ += fmt::format("<{0}{1}>{2}</{0}>\n", name, attributes, escape_html(text));
  return *this;
}

HtmlReport& HtmlReport::verdict(Verdict verdict, const std::string& headline, const std::vector<std::string>& lines) {
  const auto [box, mark] = look_of(verdict);
  body_ += fmt::format("<section class=\"verdict {}\"><p class=\"headline\"><span class=\"mark\">{}</span>{}</p>\n",
                       box, mark, escape_html(headline));
  if (!lines.empty()) list(lines);
  body_ += "</section>\n";
  return *this;
}

HtmlReport& HtmlReport::key_figures(const std::vector<KeyFigure>& figures) {
  if (figures.empty()) return *this;
  body_ += "<div class=\"figures\">\n";
  for (const KeyFigure& figure : figures) {
    body_ += fmt::format(
        "<div class=\"key {}\"><div class=\"label\">{}</div><div class=\"value\">{}</div><div "
        "class=\"small\">{}</div></div>\n",
        name_of(figure.tone), escape_html(figure.label), escape_html(figure.value), escape_html(figure.note));
  }
  body_ += "</div>\n";
  return *this;
}

HtmlReport& HtmlReport::heading(const std::string& text) {
  headings_.push_back(text);
  return element("h2", fmt::format(" id=\"section-{}\"", headings_.size()), text);
}

HtmlReport& HtmlReport::list(const std::vector<std::string>& items) {
  if (items.empty()) return *this;
  body_ += "<ul>\n";
  for (const std::string& item : items) element("li", "", item);
  body_ += "</ul>\n";
  return *this;
}

HtmlReport& HtmlReport::table(const Table& table, const std::string& caption) {
  body_ += "<div class=\"table\"><table>\n";
  if (!caption.empty())
    body_ += fmt::format("<caption><b>Table {}.</b> {}</caption>\n", ++tables_, escape_html(caption));
  body_ += "<thead><tr>";
  for (const TableColumn& column : table.columns_)
    body_ += fmt::format("<th scope=\"col\" class=\"{}\">{}</th>", name_of(column.align), escape_html(column.title));
  body_ += "</tr></thead>\n<tbody>\n";
  for (const Table::Row& row : table.rows_) {
    body_ += row.tone == Tone::plain ? "<tr>" : fmt::format("<tr class=\"{}\">", name_of(row.tone));
    for (std::size_t i = 0; i < row.cells.size(); ++i)
      body_ += fmt::format("<td class=\"{}\">{}</td>", name_of(table.columns_[i].align), escape_html(row.cells[i]));
    body_ += "</tr>\n";
  }
  if (table.rows_.empty() && !table.columns_.empty())
    body_ +=
        fmt::format("<tr class=\"muted\"><td class=\"left\" colspan=\"{}\">none</td></tr>\n", table.columns_.size());
  body_ += "</tbody></table></div>\n";
  return *this;
}

HtmlReport& HtmlReport::facts(const Facts& name_and_value) {
  if (name_and_value.empty()) return *this;
  body_ += "<dl>\n";
  for (const auto& [name, value] : name_and_value)
    body_ += fmt::format("<dt>{}</dt><dd>{}</dd>\n", escape_html(name), escape_html(value));
  body_ += "</dl>\n";
  return *this;
}

HtmlReport& HtmlReport::plot(const std::vector<PlotSpec>& panels, const std::string& caption) {
  const std::string svg = render_svg(panels, fmt::format("plot{}-", plots_ + 1));
  ++plots_;
  body_ += "<figure>" + svg;
  if (!caption.empty())
    body_ += fmt::format("\n<figcaption><b>Figure {}.</b> {}</figcaption>", plots_, escape_html(caption));
  body_ += "</figure>\n";
  return *this;
}

HtmlReport& HtmlReport::details(const std::string& summary, const std::function<void(HtmlReport&)>& content) {
  body_ += fmt::format("<details><summary>{}</summary>\n", escape_html(summary));
  try {
    content(*this);
  } catch (...) {
    body_ += "</details>\n";  // so that the caller can go on without this part
    throw;
  }
  body_ += "</details>\n";
  return *this;
}

HtmlReport& HtmlReport::footer(const std::string& text) {
  footer_ = text;
  return *this;
}

std::string HtmlReport::str() const {
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\">\n<head>\n<meta charset=\"utf-8\" />\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" "
      "/>\n<title>{0}</title>\n<style>\n{1}</style>\n"
      "</head>\n<body>\n<main>\n<header><h1>{0}</h1>\n",
      escape_html(title_), kHtmlStyle);
  if (!subtitle_.empty()) page += fmt::format("<p class=\"subtitle\">{}</p>\n", escape_html(subtitle_));
  page += "</header>\n";
  if (headings_.size() >= 3) {
    page += "<nav>";
    for (std::size_t i = 0; i < headings_.size(); ++i)
      page += fmt::format("{}<a href=\"#section-{}\">{}</a>", i == 0 ? "" : " ", i + 1, escape_html(headings_[i]));
    page += "</nav>\n";
  }
  page += body_;
  page += fmt::format("<footer>deltadyn {}{}{}</footer>\n</main>\n</body>\n</html>\n", DELTADYN_VERSION,
                      footer_.empty() ? "" : " · ", escape_html(footer_));
  return page;
}

}  // namespace deltadyn
