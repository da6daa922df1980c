#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

#include "deltadyn/runtime/error.hpp"

#include "field.hpp"
#include "recognisers.hpp"

namespace deltadyn::forms {
namespace {

using Fields = std::vector<std::string>;

/// The block of "Name", "SampleTime[ms]", "Unit", ... above the rows.
struct Header {
  char separator = '\t';
  std::map<std::string, Fields> rows;
  long first_row = 0;
};

bool is_twincat(std::string_view text) {
  const std::string_view head = text.substr(0, 4096);
  const bool begins = head.starts_with("Name") || head.starts_with("\"Name");
  return begins && head.find("Starttime of export") != std::string_view::npos;
}

Header read_header(const TextFile& file) {
  Header header;
  // What follows the word Name in the first line.
  const std::size_t behind_name = file.text.front() == '"' ? 6 : 4;
  if (behind_name < file.text.size()) header.separator = file.text[behind_name];
  std::vector<std::string_view> fields;
  bool inside = false;
  for_each_line(file.text, [&](std::string_view line, long number) {
    const bool empty = trimmed(line).find_first_not_of(header.separator) == std::string_view::npos;
    if (inside && empty) {
      header.first_row = number + 1;
      return false;
    }
    split_fields(line, header.separator, fields, true);
    // The first line is "Name" too, with the project's name; the names of the channels come after the times of the
    // export.
    inside = inside || (number > 4 && !fields.empty() && fields.front() == "Name");
    if (inside && !fields.empty())
      header.rows.emplace(std::string(fields.front()), Fields(fields.begin(), fields.end()));
    return true;
  });
  if (header.first_row == 0 || header.rows.count("Name") == 0) {
    throw Error("the rows of this TwinCAT Scope export are missing", file.path,
                "export the recording again: Scope, Export to CSV, with header and data");
  }
  const auto times = header.rows.find("SampleTime[ms]");
  if (header.separator == ' ' && times != header.rows.end() && times->second.size() != header.rows.at("Name").size()) {
    throw Error("blanks separate the columns of this TwinCAT Scope export, but names of channels hold blanks, too",
                file.path, "export the recording again with tabs or semicolons as separator");
  }
  return header;
}

std::string field_of(const Header& header, const std::string& row, std::size_t column) {
  const auto found = header.rows.find(row);
  return found == header.rows.end() || column >= found->second.size() ? "" : found->second[column];
}

/// "V (Voltage)" -> "V", "(None)" -> "".
std::string unit_of(const Header& header, std::size_t column) {
  std::string unit = field_of(header, "Unit", column);
  const auto kind = unit.find('(');
  if (kind != std::string::npos) unit.resize(kind);
  return std::string(trimmed(unit));
}

/// A number of the header.
double setting_of(const Header& header, const std::string& row, std::size_t column, double usual) {
  const std::string text = field_of(header, row, column);
  double value = 0;
  // The header follows the language of the computer, the rows the option of the export.
  const bool fine = !text.empty() && parse_number(text, text.find(',') == std::string::npos ? '.' : ',', value);
  return fine && std::isfinite(value) ? value : usual;
}

/// The rows hold the recorded variable as it is: the Scope scales and shifts on its screen only, and the unit after
/// "Unit ScaleFactor" is that of the screen. A channel with such settings says so, and its unit is unknown if that is
/// scaled.
void take_display_settings(const Header& header, std::size_t column, RecordedChannel& channel) {
  const double scale = setting_of(header, "ScaleFactor", column, 1), offset = setting_of(header, "Offset", column, 0);
  const double unit_scale = setting_of(header, "Unit ScaleFactor", column, 1),
               unit_offset = setting_of(header, "Unit Offset", column, 0);
  if (scale == 1 && offset == 0 && unit_scale == 1 && unit_offset == 0) return;
  channel.remark = fmt::format(
      "ScaleFactor {:.6g}, Offset {:.6g}, Unit ScaleFactor {:.6g} and Unit Offset {:.6g} of the header are of the "
      "Scope's display; the rows hold the recorded variable without them, so they were not applied (scale and offset "
      "in the column map would)",
      scale, offset, unit_scale, unit_offset);
  if (unit_scale == 1 && unit_offset == 0) return;
  if (!channel.unit.empty())
    channel.remark += fmt::format("; the unit {} is of the display, too, and was not taken", channel.unit);
  channel.unit.clear();
}

/// The rows' own decimal mark, from the first lines.
char decimal_of(const TextFile& file, const Header& header) {
  if (header.separator == ',') {
    // Then a decimal comma stands in quotes.
    return file.text.find("\",\"") != std::string::npos && file.text.find('.') == std::string::npos ? ',' : '.';
  }
  std::size_t points = 0, commas = 0;
  for_each_line(file.text, [&](std::string_view line, long number) {
    if (number < header.first_row) return true;
    points += static_cast<std::size_t>(std::ranges::count(line, '.'));
    commas += static_cast<std::size_t>(std::ranges::count(line, ','));
    return number < header.first_row + 1000;
  });
  return commas > points ? ',' : '.';
}

/// A time column and the channels to its right.
struct Group {
  std::size_t time = 0, end = 0;
  std::vector<long> line;
  std::vector<double> stamp;
  std::int64_t origin = 0;  ///< ticks
  bool ticks = false, dates = false;
  std::vector<std::vector<double>> values;
};

std::vector<Group> groups_of(const Header& header) {
  std::vector<Group> groups;
  const Fields& names = header.rows.at("Name");
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (names[k] == "Name") groups.push_back({k, names.size(), {}, {}, 0, false, false, {}});
    if (names[k] == "Name" && groups.size() > 1) groups[groups.size() - 2].end = k;
  }
  for (Group& group : groups) {
    while (group.end > group.time + 1 && names[group.end - 1].empty()) --group.end;  // a separator at the line's end
    group.values.resize(group.end - group.time - 1);
  }
  return groups;
}

/// One row of one group; groups of long sample times end early and leave their fields empty.
void take_row(Group& group, const std::vector<std::string_view>& fields, char decimal, long line,
              const std::string& path) {
  if (group.time >= fields.size() || fields[group.time].empty()) return;
  const std::string_view stamp = fields[group.time];
  double value = kNan;
  if (const auto ticks = long_integer(stamp);
      ticks && *ticks > kFileTimeToUnixTicks && *ticks < 2 * kFileTimeToUnixTicks) {
    if (group.line.empty()) {
      group.ticks = true;
      group.origin = *ticks;
    }
    value = static_cast<double>(*ticks - group.origin);
  } else if (!parse_number(stamp, decimal, value)) {
    const auto ns = parse_date(stamp);
    if (!ns) {
      throw Error(fmt::format("the time '{}' is not a number", stamp.substr(0, 40)),
                  fmt::format("{}, line {}", path, line), "export with time stamps in ms or ticks");
    }
    if (group.line.empty()) {
      group.dates = true;
      group.origin = *ns;
    }
    value = 1e-6 * static_cast<double>(*ns - group.origin);  // ms, as the usual stamps
  }
  group.line.push_back(line);
  group.stamp.push_back(value);
  for (std::size_t k = group.time + 1; k < group.end; ++k) {
    double number = kNan;
    if (k < fields.size() && parse_field(fields[k], decimal, number) != Field::number) number = kNan;
    group.values[k - group.time - 1].push_back(k < fields.size() ? number : kNan);
  }
}

void add_group(const Header& header, Group& group, Recording& recording) {
  Timeline timeline;
  const Fields& names = header.rows.at("Name");
  timeline.name = fmt::format("time of {}", group.end > group.time + 1 ? names[group.time + 1] : "nothing");
  timeline.unit = group.ticks ? "ticks of 100 ns" : (group.dates ? "dates" : "ms");
  const double unit_s = group.ticks ? 1e-7 : 1e-3;
  timeline.t_s =
      unit_s * Eigen::Map<Eigen::VectorXd>(group.stamp.data(), static_cast<Eigen::Index>(group.stamp.size()));
  if (group.ticks) timeline.origin_ns = (group.origin - kFileTimeToUnixTicks) * 100;
  if (group.dates) timeline.origin_ns = group.origin;
  timeline.line = std::move(group.line);
  recording.timelines.push_back(std::move(timeline));
  for (std::size_t k = 0; k < group.values.size(); ++k) {
    RecordedChannel channel;
    channel.name = names[group.time + 1 + k];
    const std::string symbol = field_of(header, "SymbolName", group.time + 1 + k);
    if (!symbol.empty()) channel.aliases.push_back(symbol);
    channel.unit = unit_of(header, group.time + 1 + k);
    take_display_settings(header, group.time + 1 + k, channel);
    channel.timeline = recording.timelines.size() - 1;
    channel.sample_time_s = 1e-3 * std::max(0.0, setting_of(header, "SampleTime[ms]", group.time + 1 + k, 0));
    auto& values = group.values[k];
    channel.values = Eigen::Map<Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    recording.channels.push_back(std::move(channel));
  }
}

}  // namespace

std::optional<Recording> read_twincat(const TextFile& file) {
  if (!is_twincat(file.text)) return std::nullopt;
  const Header header = read_header(file);
  const char decimal = decimal_of(file, header);
  Recording recording;
  recording.file = file.path;
  std::vector<Group> groups = groups_of(header);
  std::vector<std::string_view> fields;
  for_each_line(file.text, [&](std::string_view line, long number) {
    if (number < header.first_row || trimmed(line).empty()) return true;
    if (trimmed(line).starts_with("EOF")) return false;
    split_fields(line, header.separator, fields, true);
    for (Group& group : groups) take_row(group, fields, decimal, number, file.path);
    return true;
  });
  for (Group& group : groups) add_group(header, group, recording);
  recording.form = fmt::format("TwinCAT Scope, {} group{} of sample times{}", groups.size(),
                               groups.size() == 1 ? "" : "s", decimal == ',' ? ", with decimal comma" : "");
  return recording;
}

}  // namespace deltadyn::forms
