#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <set>
#include <string_view>

#include "deltadyn/io/log_units.hpp"
#include "deltadyn/runtime/error.hpp"

#include "field.hpp"
#include "recognisers.hpp"
#include "sniff.hpp"

namespace deltadyn::forms {
namespace {

constexpr std::int64_t kDayNs = 86400LL * 1000000000LL;

enum class ColumnKind { number, long_number, date };

/// One column while the rows come in.
struct Column {
  ColumnKind kind = ColumnKind::number;
  std::vector<double> values;
  std::int64_t origin = 0;
  std::int64_t last_ns = 0, midnights_ns = 0;  ///< of a clock
  long text_line = 0;
  std::string text;
};

/// How the first row's field says the column is to be read.
void begin_column(Column& column, std::string_view field, char decimal) {
  double value = 0;
  if (const auto integer = long_integer(field)) {
    column.kind = ColumnKind::long_number;
    column.origin = *integer;
  } else if (parse_field(field, decimal, value) == Field::date) {
    column.kind = ColumnKind::date;
    column.origin = column.last_ns = parse_date(field).value_or(0);
  }
}

/// Seconds after the first row; a time of day goes on after midnight.
double clock_seconds(Column& column, std::int64_t ns) {
  const bool time_of_day = column.origin < kDayNs;
  if (time_of_day && ns + kDayNs / 2 < column.last_ns) column.midnights_ns += kDayNs;
  column.last_ns = ns;
  return 1e-9 * static_cast<double>(ns + column.midnights_ns - column.origin);
}

void append(Column& column, std::string_view field, char decimal, long line) {
  double value = kNan;
  bool fine = false;
  switch (column.kind) {
    case ColumnKind::number:
      fine = parse_number(field, decimal, value) || parse_field(field, decimal, value) != Field::text;
      break;
    case ColumnKind::long_number:
      if (const auto integer = long_integer(field)) {
        value = static_cast<double>(*integer - column.origin);
        fine = true;
      } else {
        fine = parse_number(field, decimal, value);
        value -= static_cast<double>(column.origin);
      }
      break;
    case ColumnKind::date:
      if (const auto ns = parse_date(field)) {
        value = clock_seconds(column, *ns);
        fine = true;
      } else {
        fine = field.empty();
      }
      break;
  }
  if (!fine && column.text_line == 0) {
    column.text_line = line;
    column.text = std::string(field.substr(0, 40));
  }
  column.values.push_back(value);
}

/// Reads the rows of a sniffed text.
class RowReader {
 public:
  RowReader(const TextFile& file, const Layout& layout, Recording& recording)
      : file_(file), layout_(layout), recording_(recording), columns_(layout.fields) {}

  std::vector<Column> read(std::vector<long>& lines) {
    const bool ended = for_each_line(file_.text, [&](std::string_view line, long number) {
      if (number < layout_.first_row) return true;
      const std::string_view plain = trimmed(line);
      if (plain.empty() || plain.front() == '#' || plain.front() == '%') return true;
      take(line, number, lines);
      return true;
    });
    finish(ended);
    return std::move(columns_);
  }

 private:
  void take(std::string_view line, long number, std::vector<long>& lines) {
    split_fields(line, layout_.separator, fields_);
    if (fields_.size() != layout_.fields) {
      odd_.push_back({number, fields_.size(), std::string(trimmed(line).substr(0, 60))});
      return;
    }
    // A line of other shape may only stand at the end of the file, where recorders put their footers.
    if (!odd_.empty()) refuse_odd();
    if (lines.empty()) {
      for (std::size_t k = 0; k < fields_.size(); ++k) begin_column(columns_[k], fields_[k], layout_.decimal);
    }
    lines.push_back(number);
    for (std::size_t k = 0; k < fields_.size(); ++k) append(columns_[k], fields_[k], layout_.decimal, number);
  }

  void finish(bool ended) {
    if (odd_.empty()) return;
    constexpr std::size_t kFooterLines = 5;
    const bool cut_off = odd_.size() == 1 && !ended && odd_.front().fields < layout_.fields;
    const bool footer = odd_.size() <= kFooterLines && odd_.front().fields * 2 <= layout_.fields;
    if (!cut_off && !footer) refuse_odd();
    recording_.notes.push_back(fmt::format("{}, line {}: {} left out: '{}'", file_.path, odd_.front().line,
                                           cut_off ? "the last line is cut off," : "lines after the rows",
                                           odd_.front().text));
  }

  [[noreturn]] void refuse_odd() const {
    const auto& odd = odd_.front();
    throw Error(fmt::format("{} fields where the {} {}: '{}'", odd.fields,
                            layout_.header_line > 0 ? "header has" : "rows before have", layout_.fields, odd.text),
                fmt::format("{}, line {}", file_.path, odd.line),
                "mend or remove this line; if it begins another recording, put that into a file of its own");
  }

  struct OddLine {
    long line;
    std::size_t fields;
    std::string text;
  };
  const TextFile& file_;
  const Layout& layout_;
  Recording& recording_;
  std::vector<Column> columns_;
  std::vector<std::string_view> fields_;
  std::vector<OddLine> odd_;
};

/// The names of a header need not be unique; a map must be able to name each column.
void make_unique(std::vector<std::string>& names, Recording& recording) {
  std::set<std::string> taken;
  for (std::string& name : names) {
    const std::string as_found = name;
    for (int k = 2; !taken.insert(name).second; ++k) name = fmt::format("{} ({})", as_found, k);
    if (name != as_found) {
      recording.notes.push_back(fmt::format("{}: the column name {} occurs twice, the later one is called '{}' here",
                                            recording.file, as_found, name));
    }
  }
}

/// rostopic echo -p: field.position2 is of the joint whose name stands in the column field.name2; the number is a place
/// only.
void name_joints(Recording& recording) {
  for (RecordedChannel& channel : recording.channels) {
    const std::size_t digits = channel.name.find_last_not_of("0123456789") + 1;
    if (digits == channel.name.size()) continue;
    for (const std::string_view part : {"position", "velocity", "effort"}) {
      if (digits <= part.size() || channel.name.compare(digits - part.size(), part.size(), part) != 0) continue;
      const std::string name_column =
          channel.name.substr(0, digits - part.size()) + "name" + channel.name.substr(digits);
      const auto named = std::ranges::find_if(recording.channels,
                                              [&](const RecordedChannel& other) { return other.name == name_column; });
      if (named == recording.channels.end() || named->text.empty()) continue;
      channel.joint = named->text;
      channel.place = std::atoi(channel.name.c_str() + digits) + 1;
    }
  }
}

}  // namespace

Recording read_delimited(const TextFile& file) {
  Layout layout = sniff_layout(file.text, file.path);
  Recording recording;
  recording.file = file.path;
  recording.form = describe(layout);
  recording.headerless = layout.header_line == 0;
  if (layout.units.empty()) {
    for (const std::string& name : layout.names) layout.units.push_back(split_unit(name).unit);
  }
  make_unique(layout.names, recording);
  recording.timelines.resize(1);
  std::vector<Column> columns = RowReader(file, layout, recording).read(recording.timelines[0].line);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    Column& column = columns[k];
    const bool nothing = std::ranges::all_of(column.values, [](double v) { return std::isnan(v); });
    // The empty field behind a separator at the line's end.
    if (nothing && k + 1 == columns.size() && layout.names[k] == fmt::format("column{}", k + 1)) continue;
    RecordedChannel channel;
    channel.name = layout.names[k];
    channel.aliases.push_back(fmt::format("column{}", k + 1));
    channel.unit = layout.units[k];
    channel.origin = column.origin;
    channel.clock = column.kind == ColumnKind::date;
    channel.text_line = column.text_line;
    channel.text = column.text;
    channel.values = Eigen::Map<Eigen::VectorXd>(column.values.data(), static_cast<Eigen::Index>(column.values.size()));
    recording.channels.push_back(std::move(channel));
  }
  name_joints(recording);
  return recording;
}

}  // namespace deltadyn::forms
