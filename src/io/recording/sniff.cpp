#include "sniff.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>

#include "deltadyn/io/log_units.hpp"
#include "deltadyn/runtime/error.hpp"

#include "field.hpp"

namespace deltadyn::forms {
namespace {

/// A preamble may be long (TwinCAT's is 24 lines, spectrum analysers write 100), but where nothing looks like rows
/// after these there are none.
constexpr std::size_t kSampleLines = 600;
/// Rows that must follow one another before they count as the data.
constexpr std::size_t kRunOfRows = 5;

struct Line {
  std::string_view text;
  long number;
};

bool is_comment(std::string_view text) {
  return !text.empty() && (text.front() == '#' || text.front() == '%');
}

/// Lines that are not empty.
std::vector<Line> sample_of(std::string_view text) {
  std::vector<Line> lines;
  for_each_line(text, [&](std::string_view line, long number) {
    if (!trimmed(line).empty()) lines.push_back({line, number});
    return lines.size() < kSampleLines;
  });
  return lines;
}

struct RowShape {
  std::size_t fields = 0;
  double numbers = 0;  ///< fields that hold a number or a date
  bool row = false;    ///< looks like data: most of what is there are numbers
  bool last_is_empty = false;
};

struct Candidate {
  char separator, decimal;
  std::size_t first = 0;  ///< index of the first row in the sample
  std::size_t fields = 0;
  bool last_is_empty = false;  ///< the first row ends with a separator
  double score = 0;
};

RowShape shape_of(std::string_view line, char separator, char decimal, std::vector<std::string_view>& fields) {
  split_fields(line, separator, fields);
  RowShape shape{fields.size(), 0, false, fields.back().empty()};
  std::size_t filled = 0;
  for (const std::string_view field : fields) {
    double value = 0;
    const Field kind = parse_field(field, decimal, value);
    filled += field.empty() ? 0 : 1;
    shape.numbers +=
        kind == Field::number || kind == Field::date || (kind == Field::missing && !field.empty()) ? 1.0 : 0.0;
  }
  shape.row = shape.numbers > 0 && 2.0 * shape.numbers >= static_cast<double>(filled);
  return shape;
}

/// Where rows begin under these marks, and how well the rows fall into numbers.
std::optional<Candidate> try_marks(const std::vector<Line>& lines, char separator, char decimal) {
  std::vector<std::string_view> fields;
  std::vector<RowShape> shapes;
  for (const Line& line : lines) {
    shapes.push_back(is_comment(line.text) ? RowShape{} : shape_of(line.text, separator, decimal, fields));
  }
  const auto last_of_run = [&](std::size_t i) {
    std::size_t k = i;
    while (k < shapes.size() && (is_comment(lines[k].text) || (shapes[k].row && shapes[k].fields == shapes[i].fields)))
      ++k;
    return k;
  };
  for (std::size_t i = 0; i < shapes.size();) {
    if (!shapes[i].row) {
      ++i;
      continue;
    }
    const std::size_t end = last_of_run(i);
    // A file may be shorter than the run, and its last line may be cut off; but two numbers in a preamble are no rows.
    const bool at_end = end + 2 >= shapes.size();
    if (end - i < kRunOfRows && !at_end) {
      i = std::max(end, i + 1);
      continue;
    }
    // Numbers, times their share: marks that tear numbers apart give more fields, but fewer that are numbers.
    Candidate candidate{separator, decimal, i, shapes[i].fields, shapes[i].last_is_empty, 0};
    double rows = 0;
    for (std::size_t k = i; k < shapes.size(); ++k) {
      if (is_comment(lines[k].text)) continue;
      rows += 1.0;
      if (shapes[k].fields == candidate.fields) {
        candidate.score += shapes[k].numbers * shapes[k].numbers / static_cast<double>(shapes[k].fields);
      }
    }
    candidate.score /= rows;
    return candidate;
  }
  return std::nullopt;
}

std::optional<Candidate> best_marks(const std::vector<Line>& lines) {
  std::optional<Candidate> best;
  for (const char separator : {',', ';', '\t', '|', ' '}) {
    for (const char decimal : {'.', ','}) {
      const auto candidate = try_marks(lines, separator, decimal);
      // On a tie the first wins: a file of whole numbers has a point as far as anyone can tell.
      if (candidate && (!best || candidate->score > best->score * (1.0 + 1e-9))) best = candidate;
    }
  }
  return best;
}

/// "# t q1 q2", "%time,field.position0": the mark is no part of the first name.
std::string_view without_mark(std::string_view text) {
  text = trimmed(text);
  while (is_comment(text)) text = trimmed(text.substr(1));
  return text;
}

/// Names may hold blanks where blanks also separate: then tabs, or runs of blanks, set them apart.
std::vector<std::string> split_names(std::string_view text, char separator, std::size_t wanted) {
  std::vector<std::string_view> fields;
  split_fields(text, separator, fields);
  if (separator == ' ' && fields.size() != wanted) {
    for (const std::string_view mark : {"\t", "  ", ",", ";"}) {
      std::vector<std::string> names;
      for (std::string_view rest = text;;) {
        const auto end = rest.find(mark);
        if (const auto name = trimmed(rest.substr(0, end)); !name.empty()) names.emplace_back(name);
        if (end == std::string_view::npos) break;
        rest.remove_prefix(end + mark.size());
      }
      if (names.size() == wanted) return names;
    }
  }
  return {fields.begin(), fields.end()};
}

/// A separator at the end of every line, or only of the rows, or only of the names, makes no column.
bool fits(std::vector<std::string>& names, const Candidate& marks) {
  if (names.size() == marks.fields + 1 && names.back().empty()) names.pop_back();
  if (names.size() + 1 == marks.fields && marks.last_is_empty) names.emplace_back();
  return names.size() == marks.fields;
}

bool is_unit_row(const std::vector<std::string>& fields) {
  std::size_t units = 0, filled = 0;
  for (const std::string& field : fields) {
    if (field.empty() || field == "-" || field == "[-]" || field == "[]") continue;
    ++filled;
    const bool bracketed = field.size() > 2 && (field.front() == '[' || field.front() == '(');
    units += bracketed || log_unit(field) || time_unit_s(field) ? 1 : 0;
  }
  return filled > 0 && 2 * units > filled;
}

std::string without_brackets(std::string_view unit) {
  if (unit.size() >= 2 && (unit.front() == '[' || unit.front() == '(') && (unit.back() == ']' || unit.back() == ')')) {
    unit = trimmed(unit.substr(1, unit.size() - 2));
  }
  return unit == "-" ? "" : std::string(unit);
}

/// The line above the rows that holds the names: comments in between (halscope's display settings) are passed over, and
/// if no other line fits, one of them may be it ("# t q1 tau1"). Returns the number of lines if there is none.
std::size_t header_above(const std::vector<Line>& lines, const Candidate& marks) {
  const auto fitting = [&](std::size_t at) {
    std::vector<std::string> names = split_names(without_mark(lines[at].text), marks.separator, marks.fields);
    return fits(names, marks);
  };
  std::size_t commented = lines.size();
  for (std::size_t at = marks.first; at-- > 0;) {
    const bool comment = is_comment(lines[at].text);
    if (!comment) return fitting(at) || commented == lines.size() ? at : commented;
    if (commented == lines.size() && fitting(at)) commented = at;
  }
  return commented;
}

/// Names, and units, in the lines above the rows.
void find_header(const std::vector<Line>& lines, const Candidate& marks, const std::string& path, Layout& layout) {
  std::size_t at = header_above(lines, marks);
  if (at == lines.size()) return;
  std::vector<std::string> names = split_names(without_mark(lines[at].text), marks.separator, marks.fields);
  const std::vector<std::string> as_found = names;
  if (!fits(names, marks)) {
    // A table's name row stands right above its rows; what is farther away or of another kind is a preamble.
    if (as_found.size() < 2 || lines[at].number + 1 != lines[marks.first].number) return;
    throw Error(fmt::format("the header has {} names but the rows have {} fields", as_found.size(), marks.fields),
                fmt::format("{}, line {}", path, lines[at].number),
                "name every column once, with the same separator as in the rows");
  }
  if (at > 0 && is_unit_row(names)) {
    std::vector<std::string> above = split_names(without_mark(lines[at - 1].text), marks.separator, marks.fields);
    if (fits(above, marks)) {
      for (const std::string& unit : names) layout.units.push_back(without_brackets(unit));
      names = above;
      --at;
    }
  }
  layout.header_line = lines[at].number;
  layout.names = std::move(names);
}

}  // namespace

Layout sniff_layout(std::string_view text, const std::string& path) {
  const std::vector<Line> lines = sample_of(text);
  if (lines.empty()) throw Error("the file is empty", path, "check that the recording or its export is complete");
  const auto marks = best_marks(lines);
  if (!marks) {
    const auto named = std::ranges::find_if(lines, [](const Line& line) { return !is_comment(line.text); });
    const bool header_only = lines.size() <= 2 && named != lines.end();
    throw Error(header_only ? "the file holds a header but no data rows" : "no rows of numbers are found in this file",
                path,
                header_only ? "check that the recording is complete"
                            : "export the recording as a table: one line a sample, columns separated by comma, "
                              "semicolon, tab or blanks");
  }
  Layout layout;
  layout.separator = marks->separator;
  layout.decimal = marks->decimal;
  layout.fields = marks->fields;
  layout.first_row = lines[marks->first].number;
  find_header(lines, *marks, path, layout);
  layout.names.resize(layout.fields);
  for (std::size_t k = 0; k < layout.names.size(); ++k) {
    if (layout.names[k].empty()) layout.names[k] = fmt::format("column{}", k + 1);
  }
  return layout;
}

std::string describe(const Layout& layout) {
  std::string by = fmt::format("'{}'", layout.separator);
  if (layout.separator == '\t') by = "tabs";
  if (layout.separator == ' ') by = "blanks";
  return fmt::format("text separated by {}{}{}", by, layout.decimal == ',' ? ", with decimal comma" : "",
                     layout.header_line == 0 ? ", without a header" : "");
}

}  // namespace deltadyn::forms
