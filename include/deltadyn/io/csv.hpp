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

/// A CSV file row by row.
class CsvReader {
 public:
  /// Opens the file and reads the header. Throws Error(bad_input): missing, unreadable, empty or binary file, empty or
  /// repeated column name.
  explicit CsvReader(const std::string& path);
  CsvReader(const CsvReader&) = delete;  // its fields are places in its text
  CsvReader& operator=(const CsvReader&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::vector<std::string>& columns() const { return columns_; }
  /// Index of a column, if there is one of this name.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view column) const;
  /// What follows `key` in the first comment above the header that begins with it: of "# version 2" with the key
  /// "version" it is "2".
  [[nodiscard]] std::optional<std::string> comment(std::string_view key) const;

  /// Moves to the next data row; false at the end. Throws Error(bad_input) if the row has not as many fields as the
  /// header.
  bool next_row();
  /// Line of the current row in the file, the first line is 1.
  [[nodiscard]] long line() const { return line_; }
  /// Text of the current row, without blanks around it; valid as long as the reader.
  [[nodiscard]] std::string_view text(std::size_t column) const { return fields_[column]; }
  /// Number of the current row. Throws Error(bad_input) if it is not a finite number.
  [[nodiscard]] double number(std::size_t column) const;
  /// Like number(), but an empty field, "nan" and "inf" give NaN.
  [[nodiscard]] double number_or_nan(std::size_t column) const;

 private:
  /// Moves to the next line that is neither empty nor a comment and splits it; false at the end.
  bool next_line();

  std::string path_, text_;
  std::string_view rest_;  ///< of the text: the lines to come
  long line_ = 0;
  std::vector<std::string> comments_;  ///< above the header, without the mark
  std::vector<std::string> columns_;
  std::vector<std::string_view> fields_;
};

/// A whole CSV file in memory.
class CsvTable {
 public:
  /// As CsvReader::comment.
  [[nodiscard]] std::optional<std::string> comment(std::string_view key) const { return file_->comment(key); }
  [[nodiscard]] const std::string& path() const { return file_->path(); }
  [[nodiscard]] const std::vector<std::string>& columns() const { return file_->columns(); }
  [[nodiscard]] std::size_t rows() const { return lines_.size(); }
  [[nodiscard]] std::optional<std::size_t> find(std::string_view column) const { return file_->find(column); }
  /// Index of a column. Throws Error(bad_input) that names the columns there are.
  [[nodiscard]] std::size_t require(std::string_view column) const;
  /// Line of a row in the file, the first line is 1.
  [[nodiscard]] long line(std::size_t row) const { return lines_[row]; }
  [[nodiscard]] std::string_view text(std::size_t row, std::size_t column) const {
    return fields_[row * columns().size() + column];
  }
  /// Throws Error(bad_input) with file, line and column if the field is not a finite number.
  [[nodiscard]] double number(std::size_t row, std::size_t column) const;
  /// All numbers of a column. Throws as require() and number().
  [[nodiscard]] Eigen::VectorXd numbers(std::string_view column) const;

 private:
  friend CsvTable read_csv(const std::string& path);
  std::shared_ptr<const CsvReader> file_;  ///< holds the text of the fields
  std::vector<long> lines_;
  std::vector<std::string_view> fields_;  ///< row after row
};

/// Throws Error(bad_input) as CsvReader does, and if there is no data row.
[[nodiscard]] CsvTable read_csv(const std::string& path);

/// "log.csv, line 12, column q1_rad"; parts that are 0 or empty are left out.
[[nodiscard]] std::string place(std::string_view path, long line, std::string_view column = {});

}  // namespace deltadyn
