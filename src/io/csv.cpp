#include "deltadyn/io/csv.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "deltadyn/runtime/error.hpp"

#include "recording/field.hpp"
#include "recording/recognisers.hpp"

namespace deltadyn {
namespace {

using forms::trimmed;

/// No row of a log is nearly as long.
constexpr std::size_t kLongestLine = 1 << 24;

enum class Parsed { number, not_finite, empty, text };

Parsed parse(std::string_view text, double& value) {
  if (text.empty()) return Parsed::empty;
  if (!forms::parse_decimal(text, value)) return Parsed::text;
  return std::isfinite(value) ? Parsed::number : Parsed::not_finite;
}

[[noreturn]] void refuse_number(Parsed parsed, std::string_view text, const std::string& where) {
  switch (parsed) {
    case Parsed::empty:
      throw Error("the field is empty, a number is needed", where, "fill in the number or remove the row");
    case Parsed::not_finite:
      throw Error(fmt::format("'{}' is not a finite number", text), where, "remove the row or correct the value");
    default:
      throw Error(fmt::format("'{}' is not a number", text.substr(0, 40)), where,
                  "write numbers with a decimal point and without unit or quotes");
  }
}

double finite_number(std::string_view text, const std::string& path, long line, std::string_view column) {
  double value = 0;
  const Parsed parsed = parse(text, value);
  if (parsed != Parsed::number) refuse_number(parsed, text, place(path, line, column));
  return value;
}

}  // namespace

std::string place(std::string_view path, long line, std::string_view column) {
  std::string where(path);
  if (line > 0) where += fmt::format(", line {}", line);
  if (!column.empty()) where += fmt::format(", column {}", column);
  return where;
}

CsvReader::CsvReader(const std::string& path) : path_(path), text_(forms::read_bytes(path, "give the CSV file")) {
  forms::refuse_zero_bytes(path, text_);
  rest_ = text_;
  if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
  if (!next_line()) throw Error("the file is empty", path, "the first line must hold the column names");
  double ignored = 0;
  if (std::ranges::all_of(fields_, [&](std::string_view name) { return parse(name, ignored) == Parsed::number; })) {
    throw Error("the header line is missing: the first line holds numbers only", place(path, line_),
                "add a first line with the column names, separated by commas");
  }
  for (const std::string_view name : fields_) {
    if (name.empty()) {
      throw Error(fmt::format("column {} has no name", columns_.size() + 1), place(path, line_),
                  "name every column in the header line");
    }
    if (find(name)) {
      throw Error(fmt::format("the column name {} occurs twice", name), place(path, line_),
                  "rename or remove one of them");
    }
    columns_.emplace_back(name);
  }
}

bool CsvReader::next_line() {
  while (!rest_.empty()) {
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    const std::string_view line = trimmed(rest_.substr(0, end));
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++line_;
    if (end > kLongestLine)
      throw Error("the line is too long for a CSV file", place(path_, line_), "check that this is a CSV file");
    if (line.starts_with('#') && columns_.empty()) comments_.emplace_back(trimmed(line.substr(1)));
    if (line.empty() || line.front() == '#') continue;
    forms::split_at_commas(line, fields_);
    return true;
  }
  return false;
}

std::optional<std::size_t> CsvReader::find(std::string_view column) const {
  const auto found = std::ranges::find(columns_, column);
  if (found == columns_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns_.begin());
}

std::optional<std::string> CsvReader::comment(std::string_view key) const {
  const auto found = std::ranges::find_if(comments_, [&](const std::string& one) { return one.starts_with(key); });
  if (found == comments_.end()) return std::nullopt;
  return std::string(trimmed(std::string_view(*found).substr(key.size())));
}

bool CsvReader::next_row() {
  if (!next_line()) return false;
  if (fields_.size() != columns_.size()) {
    throw Error(fmt::format("{} fields where the header has {}", fields_.size(), columns_.size()), place(path_, line_),
                "separate the fields by commas, one for each column of the header");
  }
  return true;
}

double CsvReader::number(std::size_t column) const {
  return finite_number(fields_[column], path_, line_, columns_[column]);
}

double CsvReader::number_or_nan(std::size_t column) const {
  double value = 0;
  const Parsed parsed = parse(fields_[column], value);
  if (parsed == Parsed::text) refuse_number(parsed, fields_[column], place(path_, line_, columns_[column]));
  return parsed == Parsed::number ? value : forms::kNan;
}

std::size_t CsvTable::require(std::string_view column) const {
  if (const auto index = find(column)) return *index;
  throw Error(fmt::format("the column {} is missing; the file has {}", column, fmt::join(columns(), ", ")), path(),
              fmt::format("add the column {} or correct its name", column));
}

double CsvTable::number(std::size_t row, std::size_t column) const {
  return finite_number(text(row, column), path(), lines_[row], columns()[column]);
}

Eigen::VectorXd CsvTable::numbers(std::string_view column) const {
  const std::size_t index = require(column);
  Eigen::VectorXd values(static_cast<Eigen::Index>(rows()));
  for (std::size_t row = 0; row < rows(); ++row) values(static_cast<Eigen::Index>(row)) = number(row, index);
  return values;
}

CsvTable read_csv(const std::string& path) {
  const auto file = std::make_shared<CsvReader>(path);
  CsvTable table;
  table.file_ = file;
  while (file->next_row()) {
    table.lines_.push_back(file->line());
    for (std::size_t column = 0; column < file->columns().size(); ++column) table.fields_.push_back(file->text(column));
  }
  if (table.lines_.empty())
    throw Error("the file holds a header but no data rows", path, "check that the export is complete");
  return table;
}

}  // namespace deltadyn
