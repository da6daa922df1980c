#include "deltadyn/io/log_file.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <optional>
#include <string_view>
#include <utility>

#include "deltadyn/io/csv.hpp"
#include "deltadyn/io/import_log.hpp"
#include "deltadyn/io/log_units.hpp"
#include "deltadyn/io/output_file.hpp"
#include "deltadyn/runtime/error.hpp"

#include "guess_columns.hpp"
#include "recording/field.hpp"

namespace deltadyn {
namespace {

constexpr const char* kPrefix[] = {"q", "qd", "qdd", "tau"};

/// Units in the names of columns, of each quantity and kind of drive the SI one first.
constexpr const char* kUnitEnds[] = {"_rad", "_deg",    "_m",      "_rad_s", "_deg_s", "_rpm",
                                     "_m_s", "_rad_s2", "_deg_s2", "_m_s2",  "_Nm",    "_N"};

/// "q1", from drive 0 on.
std::string stem_of(Quantity quantity, int drive) {
  return fmt::format("{}{}", kPrefix[static_cast<std::size_t>(quantity)], drive + 1);
}

/// A name that a column may have.
struct Spelling {
  std::string name;
  double factor;  ///< to SI
};

std::vector<Spelling> spellings(Quantity quantity, DriveKind kind, int drive) {
  std::vector<Spelling> fitting;
  for (const char* end : kUnitEnds) {
    const LogUnit unit = log_unit(end + 1).value();
    const bool turns = unit.dimension == Dimension::angle || unit.dimension == Dimension::moment;
    if (unit.quantity == quantity && turns == (kind == DriveKind::revolute))
      fitting.push_back({stem_of(quantity, drive) + end, unit.factor});
  }
  return fitting;
}

struct Source {
  std::size_t column;
  double factor;
};

std::optional<Source> find_source(const CsvReader& reader, Quantity quantity, DriveKind kind, int drive) {
  for (const Spelling& spelling : spellings(quantity, kind, drive)) {
    if (const auto column = reader.find(spelling.name)) return Source{*column, spelling.factor};
  }
  return std::nullopt;
}

/// Lower case without separators, so that "Q1", "q_1" and "q1" are alike.
std::string simplified(const std::string& name) {
  std::string result = forms::lower(name);
  std::erase_if(result, [](unsigned char c) { return std::isalnum(c) == 0; });
  return result;
}

/// Columns that the user may have meant: those that begin with "q1" but not with "q10".
std::vector<std::string> similar_columns(const CsvReader& reader, const std::string& stem) {
  std::vector<std::string> found;
  for (const std::string& name : reader.columns()) {
    const std::string plain = simplified(name);
    const bool begins = plain.starts_with(stem);
    const bool other_number = plain.size() > stem.size() && forms::is_digit(plain[stem.size()]);
    if (begins && !other_number) found.push_back(name);
  }
  return found;
}

[[noreturn]] void refuse_missing(const CsvReader& reader, Quantity quantity, DriveKind kind, int drive) {
  std::vector<std::string> accepted;
  for (const Spelling& spelling : spellings(quantity, kind, drive)) accepted.push_back(spelling.name);
  const std::string& wanted = accepted.front();
  const auto similar = similar_columns(reader, stem_of(quantity, drive));
  if (similar.empty()) {
    throw Error(fmt::format("the column {} is missing; the file has {}", wanted, fmt::join(reader.columns(), ", ")),
                reader.path(), fmt::format("add the column {}, or give the robot file that fits the log", wanted));
  }
  const DriveKind other = kind == DriveKind::revolute ? DriveKind::prismatic : DriveKind::revolute;
  const auto others = spellings(quantity, other, drive);
  std::string why;
  if (std::ranges::find(others, similar.front(), &Spelling::name) != others.end()) {
    why = fmt::format(", which is for a {} drive, but drive {} of the robot is {}",
                      other == DriveKind::revolute ? "revolute" : "prismatic", drive + 1,
                      kind == DriveKind::revolute ? "revolute" : "prismatic");
  }
  throw Error(
      fmt::format("the column {} is missing; the file has {}{}", wanted, fmt::join(similar, ", "), why), reader.path(),
      why.empty() ? fmt::format("name the column {}", fmt::join(accepted, " or "))
                  : std::string("give the robot file that fits the log, or correct the unit in the column's name"));
}

/// Sources of one quantity for all drives; empty if a drive lacks it and it is not needed.
std::vector<Source> sources(const CsvReader& reader, const RobotDescription& robot, Quantity quantity, bool needed,
                            std::vector<std::string>& notes) {
  std::vector<Source> result;
  std::string missing;
  for (int drive = 0; drive < robot.drives(); ++drive) {
    const DriveKind kind = robot.kind_of_drive(drive);
    if (const auto source = find_source(reader, quantity, kind, drive)) {
      result.push_back(*source);
    } else if (needed) {
      refuse_missing(reader, quantity, kind, drive);
    } else if (missing.empty()) {
      missing = contract_name(robot, drive, quantity);
    }
  }
  if (missing.empty()) return result;
  if (!result.empty()) {
    notes.push_back(fmt::format("{}: {} is missing, so the {} columns of the other drives are not used", reader.path(),
                                missing, kPrefix[static_cast<std::size_t>(quantity)]));
  }
  return {};
}

std::size_t time_column(const CsvReader& reader) {
  if (const auto column = reader.find("t_s")) return *column;
  std::vector<std::string> times = similar_columns(reader, "t");
  std::erase_if(times, [](const std::string& name) { return simplified(name).starts_with("tau"); });
  if (times.empty()) times = reader.columns();
  throw Error(fmt::format("the column t_s is missing; the file has {}", fmt::join(times, ", ")), reader.path(),
              "add the time in seconds as column t_s");
}

/// The first line that is neither empty nor a comment, if the beginning of the file holds one.
std::string first_line(const std::string& path) {
  constexpr std::size_t kHead = 1 << 18;
  std::ifstream file(path, std::ios::binary);
  std::string head(kHead, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  std::string_view rest = head;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
  while (!rest.empty()) {
    const auto end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    if (const auto plain = forms::trimmed(line); !plain.empty() && plain.front() != '#') return std::string(line);
    if (end == std::string_view::npos) break;
    rest.remove_prefix(end + 1);
  }
  return "";
}

/// "q12_deg": a position of the contract, of any drive.
bool is_position_name(std::string_view name) {
  if (!name.starts_with('q')) return false;
  const auto end = name.find_first_not_of("0123456789", 1);
  if (end == 1 || end == std::string_view::npos) return false;
  const std::string_view unit = name.substr(end);
  return unit == "_rad" || unit == "_deg" || unit == "_m";
}

/// Positions of drives that the robot does not have.
std::vector<std::string> positions_beyond(const CsvReader& reader, int drives) {
  std::vector<std::string> names;
  for (const std::string& name : reader.columns()) {
    if (is_position_name(name) && std::atoi(name.c_str() + 1) > drives) names.push_back(name);
  }
  return names;
}

/// Whether the header is one of these tools' logs: t_s and a position, separated by commas.
bool is_contract_header(std::string_view line) {
  std::vector<std::string_view> names;
  forms::split_at_commas(line, names);
  return std::ranges::find(names, "t_s") != names.end() && std::ranges::any_of(names, is_position_name);
}

/// Whether the columns that are needed have the names of the contract.
bool is_complete(const std::string& path, const RobotDescription& robot, const LogReadOptions& options) {
  const CsvReader reader(path);
  const auto has = [&](Quantity quantity, bool needed) {
    for (int drive = 0; needed && drive < robot.drives(); ++drive) {
      if (!find_source(reader, quantity, robot.kind_of_drive(drive), drive)) return false;
    }
    return true;
  };
  return has(Quantity::position, true) && has(Quantity::velocity, options.need_derivatives) &&
         has(Quantity::acceleration, options.need_derivatives) && has(Quantity::torque, options.need_torque);
}

/// A log of another form, with what was taken for what as its first note.
Log read_foreign(const std::string& path, const RobotDescription& robot, const LogReadOptions& options) {
  return LogImport({path}, robot,
                   {.map_file = options.map,
                    .need_torque = options.need_torque,
                    .need_derivatives = options.need_derivatives})
      .log()
      .log;
}

Log read_contract(const std::string& path, const RobotDescription& robot, const LogReadOptions& options) {
  CsvReader reader(path);
  Log log;
  log.file = path;
  const std::size_t time = time_column(reader);
  struct Target {
    std::vector<Source> from;
    Eigen::MatrixXd* to;
  };
  const Target blocks[] = {
      {sources(reader, robot, Quantity::position, true, log.notes), &log.q},
      {sources(reader, robot, Quantity::velocity, options.need_derivatives, log.notes), &log.qd},
      {sources(reader, robot, Quantity::acceleration, options.need_derivatives, log.notes), &log.qdd},
      {sources(reader, robot, Quantity::torque, options.need_torque, log.notes), &log.tau},
  };
  if (const auto extra = positions_beyond(reader, robot.drives()); !extra.empty()) {
    const std::string taken =
        robot.drives() == 1 ? "drive, so q1 was" : fmt::format("drives, so q1 to q{} were", robot.drives());
    log.notes.push_back(fmt::format("{}: the robot {} has {} {} taken; {} {} not used", path, robot.type,
                                    robot.drives(), taken, fmt::join(extra, ", "), extra.size() == 1 ? "is" : "are"));
  }

  std::vector<double> values;  // row after row
  std::size_t width = 1;
  for (const Target& block : blocks) width += block.from.size();
  while (reader.next_row()) {
    log.line.push_back(reader.line());
    values.push_back(reader.number_or_nan(time));
    for (const Target& block : blocks) {
      for (const Source& source : block.from) values.push_back(reader.number_or_nan(source.column) * source.factor);
    }
  }
  if (log.line.empty())
    throw Error("the file holds a header but no data rows", path, "check that the recording is complete");

  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Map<const RowMajor> table(values.data(), static_cast<Eigen::Index>(log.line.size()),
                                         static_cast<Eigen::Index>(width));
  log.t_s = table.col(0);
  Eigen::Index column = 1;
  for (const Target& block : blocks) {
    const auto count = static_cast<Eigen::Index>(block.from.size());
    if (count > 0) *block.to = table.middleCols(column, count);
    column += count;
  }
  return log;
}

Log read_any(const std::string& path, const RobotDescription& robot, const LogReadOptions& options) {
  if (!options.map.empty() || !is_contract_header(first_line(path))) return read_foreign(path, robot, options);
  if (is_complete(path, robot, options)) return read_contract(path, robot, options);
  try {
    return read_foreign(path, robot, options);  // a column of another spelling
  } catch (const Error&) {
    return read_contract(path, robot, options);  // names the column of the contract that is missing
  }
}

}  // namespace

Log read_log(const std::string& path, const RobotDescription& robot, const LogReadOptions& options) {
  Log log = read_any(path, robot, options);
  if (options.check) check_and_repair(log, robot, options.checks);
  return log;
}

std::vector<Log> read_log_parts(const std::string& path, const RobotDescription& robot, const LogReadOptions& options) {
  LogReadOptions unchecked = options;
  unchecked.check = false;
  Log log = read_log(path, robot, unchecked);
  if (!options.check) return {std::move(log)};
  return check_and_split(std::move(log), robot, options.checks);
}

void write_log(const std::string& path, const Log& log, const RobotDescription& robot) {
  const std::pair<Quantity, const Eigen::MatrixXd*> blocks[] = {{Quantity::position, &log.q},
                                                                {Quantity::velocity, &log.qd},
                                                                {Quantity::acceleration, &log.qdd},
                                                                {Quantity::torque, &log.tau}};
  std::string header = "t_s";
  std::vector<const Eigen::MatrixXd*> columns;
  for (const auto& [quantity, block] : blocks) {
    for (int drive = 0; drive < block->cols(); ++drive) header += "," + contract_name(robot, drive, quantity);
    columns.push_back(block);
  }
  write_table(path, header, log.t_s, columns);
}

}  // namespace deltadyn
