#pragma once

/// \file
/// Headed CSV: comma separated, one header line, lines that start with '#' are comments, columns in any order.
/// Accepts a byte-order mark, CR LF line ends, blanks around fields and empty lines. There is no quoting.

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace deltadyn {

class CsvTable;

/// Reads a CSV file row by row in constant memory.
class CsvReader {
 public:
  /// Opens the file and reads the header. Throws Error(bad_input): missing, unreadable, empty or binary file, empty or
  /// repeated column name.
  explicit CsvReader(const std::string& path);
  ~CsvReader();
  CsvReader(const CsvReader&) = delete;
  CsvReader& operator=(const CsvReader&) = delete;

  [[nodiscard]] const std::string& path() const;
  [[nodiscard]] const std::vector<std::string>& columns() const;
  /// Index of a column, if there is one of this name.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view column) const;
  /// What follows `key` in the first comment above the header that begins with it: of "# version 2" with the key
  /// "version" it is "2".
  [[nodiscard]] std::optional<std::string> comment(std::string_view key) const;

  /// Moves to the next data row; false at the end. Throws Error(bad_input) if the row has not as many fields as the
  /// header.
  bool next_row();
  /// Line of the current row in the file, the first line is 1.
  [[nodiscard]] long line() const;
  /// Text of the current row, without blanks around it; valid until next_row().
  [[nodiscard]] std::string_view text(std::size_t column) const;
  /// Number of the current row. Throws Error(bad_input) if it is not a finite number.
  [[nodiscard]] double number(std::size_t column) const;
  /// Like number(), but an empty field, "nan" and "inf" give NaN.
  [[nodiscard]] double number_or_nan(std::size_t column) const;

 private:
  friend CsvTable read_csv(const std::string& path);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A whole CSV file in memory.
class CsvTable {
 public:
  /// As CsvReader::comment.
  [[nodiscard]] std::optional<std::string> comment(std::string_view key) const;
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::vector<std::string>& columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return lines_.size(); }
  [[nodiscard]] std::optional<std::size_t> find(std::string_view column) const;
  /// Index of a column. Throws Error(bad_input) that names the columns there are.
  [[nodiscard]] std::size_t require(std::string_view column) const;
  /// Line of a row in the file, the first line is 1.
  [[nodiscard]] long line(std::size_t row) const { return lines_[row]; }
  [[nodiscard]] std::string_view text(std::size_t row, std::size_t column) const;
  /// Throws Error(bad_input) with file, line and column if the field is not a finite number.
  [[nodiscard]] double number(std::size_t row, std::size_t column) const;
  /// All numbers of a column. Throws as require() and number().
  [[nodiscard]] Eigen::VectorXd numbers(std::string_view column) const;

 private:
  friend CsvTable read_csv(const std::string& path);
  std::string path_;
  std::vector<std::string> comments_, columns_;
  std::vector<long> lines_;
  std::string text_;
  std::vector<std::size_t> ends_;  ///< of each field in text_
};

/// Throws Error(bad_input) as CsvReader does, and if there is no data row.
[[nodiscard]] CsvTable read_csv(const std::string& path);

/// "log.csv, line 12, column q1_rad"; parts that are 0 or empty are left out.
[[nodiscard]] std::string place(std::string_view path, long line, std::string_view column = {});

}  // namespace deltadyn
