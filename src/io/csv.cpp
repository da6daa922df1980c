#include "deltadyn/io/csv.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wstringop-truncation"  // it shortens file names in messages of its own, on purpose
#endif
#include <libfccp/csv.h>
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>

#include "deltadyn/runtime/error.hpp"

#include "recording/field.hpp"

namespace deltadyn {
namespace detail {

/// Bytes of a file, with a line feed added after the last line if it has none: the line reader relies on it.
/// Remembers what must be told to the user; the line reader itself passes nothing on.
class CheckedSource : public io::ByteSourceBase {
 public:
  struct Findings {
    int read_error = 0;
    bool has_zero_byte = false;
  };

  CheckedSource(std::FILE* file, Findings& findings) : file_(file), findings_(findings) {}
  ~CheckedSource() override { std::fclose(file_); }
  CheckedSource(const CheckedSource&) = delete;
  CheckedSource& operator=(const CheckedSource&) = delete;

  int read(char* buffer, int size) override {
    const auto wanted = static_cast<std::size_t>(size);
    std::size_t got = std::fread(buffer, 1, wanted, file_);
    if (got > 0) {
      last_ = buffer[got - 1];
      if (std::memchr(buffer, 0, got) != nullptr) findings_.has_zero_byte = true;
    }
    if (got < wanted) {
      if (std::ferror(file_) != 0) findings_.read_error = errno;
      if (last_ != '\n') buffer[got++] = last_ = '\n';
    }
    return static_cast<int>(got);
  }

 private:
  std::FILE* file_;
  Findings& findings_;
  char last_ = '\n';  // an empty file gets no line feed
};

}  // namespace detail

namespace {

using forms::trimmed;

void split(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  for (;;) {
    const auto comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return;
    line.remove_prefix(comma + 1);
  }
}

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

std::optional<std::size_t> index_of(const std::vector<std::string>& columns, std::string_view column) {
  const auto found = std::ranges::find(columns, column);
  if (found == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns.begin());
}

std::optional<std::string> comment_of(const std::vector<std::string>& comments, std::string_view key) {
  for (const std::string& comment : comments) {
    if (comment.compare(0, key.size(), key) == 0)
      return std::string(trimmed(std::string_view(comment).substr(key.size())));
  }
  return std::nullopt;
}

}  // namespace

std::string place(std::string_view path, long line, std::string_view column) {
  std::string where(path);
  if (line > 0) where += fmt::format(", line {}", line);
  if (!column.empty()) where += fmt::format(", column {}", column);
  return where;
}

struct CsvReader::Impl {
  std::string path;
  detail::CheckedSource::Findings findings;
  std::unique_ptr<io::LineReader> lines;
  std::vector<std::string> comments;  ///< above the header, without the mark
  std::vector<std::string> columns;
  std::vector<std::string_view> fields;

  [[nodiscard]] long line() const { return static_cast<long>(lines->get_file_line()); }

  /// Next line that is neither empty nor a comment.
  bool next(std::string_view& text) {
    try {
      while (const char* raw = lines->next_line()) {
        refuse_damage();
        text = trimmed(raw);
        if (text.empty()) continue;
        if (text.front() != '#') return true;
        if (columns.empty()) comments.emplace_back(trimmed(text.substr(1)));
      }
    } catch (const io::error::base&) {
      throw Error("the line is too long for a CSV file", place(path, line() + 1), "check that this is a CSV file");
    }
    refuse_damage();
    return false;
  }

  void refuse_damage() const {
    if (findings.read_error != 0) {
      throw Error(fmt::format("cannot read the file: {}", std::strerror(findings.read_error)), path,
                  "check the path and the disk");
    }
    if (findings.has_zero_byte) {
      throw Error("the file holds zero bytes, so it is not a text file", path, "export it as CSV in UTF-8 or ASCII");
    }
  }
};

CsvReader::CsvReader(const std::string& path) : impl_(std::make_unique<Impl>()) {
  impl_->path = path;
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw Error("this is a folder, not a file", path, "give the CSV file");
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) {
    throw Error(fmt::format("cannot open the file: {}", std::strerror(errno)), path,
                "check the path and the permissions");
  }
  impl_->lines = std::make_unique<io::LineReader>(path, std::make_unique<detail::CheckedSource>(file, impl_->findings));
  std::string_view header;
  if (!impl_->next(header)) throw Error("the file is empty", path, "the first line must hold the column names");
  split(header, impl_->fields);
  double ignored_value = 0;
  if (std::ranges::all_of(impl_->fields,
                          [&](std::string_view field) { return parse(field, ignored_value) == Parsed::number; })) {
    throw Error("the header line is missing: the first line holds numbers only", place(path, impl_->line()),
                "add a first line with the column names, separated by commas");
  }
  for (std::size_t i = 0; i < impl_->fields.size(); ++i) {
    const std::string_view name = impl_->fields[i];
    if (name.empty()) {
      throw Error(fmt::format("column {} has no name", i + 1), place(path, impl_->line()),
                  "name every column in the header line");
    }
    if (index_of(impl_->columns, name)) {
      throw Error(fmt::format("the column name {} occurs twice", name), place(path, impl_->line()),
                  "rename or remove one of them");
    }
    impl_->columns.emplace_back(name);
  }
}

CsvReader::~CsvReader() = default;

const std::string& CsvReader::path() const {
  return impl_->path;
}
const std::vector<std::string>& CsvReader::columns() const {
  return impl_->columns;
}
std::optional<std::size_t> CsvReader::find(std::string_view column) const {
  return index_of(impl_->columns, column);
}
std::optional<std::string> CsvReader::comment(std::string_view key) const {
  return comment_of(impl_->comments, key);
}
long CsvReader::line() const {
  return impl_->line();
}
std::string_view CsvReader::text(std::size_t column) const {
  return impl_->fields[column];
}

bool CsvReader::next_row() {
  std::string_view row;
  if (!impl_->next(row)) return false;
  split(row, impl_->fields);
  if (impl_->fields.size() != impl_->columns.size()) {
    throw Error(fmt::format("{} fields where the header has {}", impl_->fields.size(), impl_->columns.size()),
                place(impl_->path, impl_->line()), "separate the fields by commas, one for each column of the header");
  }
  return true;
}

double CsvReader::number(std::size_t column) const {
  return finite_number(impl_->fields[column], impl_->path, impl_->line(), impl_->columns[column]);
}

double CsvReader::number_or_nan(std::size_t column) const {
  double value = 0;
  const Parsed parsed = parse(impl_->fields[column], value);
  if (parsed == Parsed::text) {
    refuse_number(parsed, impl_->fields[column], place(impl_->path, impl_->line(), impl_->columns[column]));
  }
  return parsed == Parsed::number ? value : std::numeric_limits<double>::quiet_NaN();
}

std::optional<std::string> CsvTable::comment(std::string_view key) const {
  return comment_of(comments_, key);
}

std::optional<std::size_t> CsvTable::find(std::string_view column) const {
  return index_of(columns_, column);
}

std::size_t CsvTable::require(std::string_view column) const {
  if (const auto index = find(column)) return *index;
  throw Error(fmt::format("the column {} is missing; the file has {}", column, fmt::join(columns_, ", ")), path_,
              fmt::format("add the column {} or correct its name", column));
}

std::string_view CsvTable::text(std::size_t row, std::size_t column) const {
  const std::size_t field = row * columns_.size() + column;
  const std::size_t begin = field == 0 ? 0 : ends_[field - 1];
  return std::string_view(text_).substr(begin, ends_[field] - begin);
}

double CsvTable::number(std::size_t row, std::size_t column) const {
  return finite_number(text(row, column), path_, lines_[row], columns_[column]);
}

Eigen::VectorXd CsvTable::numbers(std::string_view column) const {
  const std::size_t index = require(column);
  Eigen::VectorXd values(static_cast<Eigen::Index>(rows()));
  for (std::size_t row = 0; row < rows(); ++row) values(static_cast<Eigen::Index>(row)) = number(row, index);
  return values;
}

CsvTable read_csv(const std::string& path) {
  CsvReader reader(path);
  CsvTable table;
  table.path_ = path;
  table.comments_ = reader.impl_->comments;
  table.columns_ = reader.columns();
  while (reader.next_row()) {
    table.lines_.push_back(reader.line());
    for (std::size_t column = 0; column < table.columns_.size(); ++column) {
      table.text_ += reader.text(column);
      table.ends_.push_back(table.text_.size());
    }
  }
  if (table.lines_.empty())
    throw Error("the file holds a header but no data rows", path, "check that the export is complete");
  return table;
}

}  // namespace deltadyn
