#pragma once

/// \file
/// Fields of text exports: numbers in the spellings of the world, dates, and how lines fall into fields.

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace deltadyn::forms {

[[nodiscard]] std::string_view trimmed(std::string_view text);
[[nodiscard]] constexpr bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
[[nodiscard]] std::string lower(std::string_view text);
/// The text with `to` in place of each `from`.
[[nodiscard]] std::string with_each(std::string text, std::string_view from, std::string_view to);

/// Stands for a number that is missing.
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// From 1601, where Windows begins to count, to 1970 in ticks of 100 ns.
inline constexpr std::int64_t kFileTimeToUnixTicks = 116444736000000000LL;

enum class Field { number, missing, date, text };

/// What a field says. `value` is NaN for a missing number ("", "nan", "n/a", "-", ...); words of truth are 1 and 0.
/// \param decimal  '.' or ','
[[nodiscard]] Field parse_field(std::string_view field, char decimal, double& value);

/// Only numbers and missing numbers; false for anything else. The fast way through a column known to hold numbers.
[[nodiscard]] bool parse_number(std::string_view field, char decimal, double& value);

/// A number with a decimal point, NaN if it is not finite or too large; false for any other text.
[[nodiscard]] bool parse_decimal(std::string_view text, double& value);

/// An integer of more than 15 digits, which a double cannot hold.
[[nodiscard]] std::optional<std::int64_t> long_integer(std::string_view field);

/// Date and time, or time of day alone, as ns since 1970 (or midnight): ISO 8601, 31.12.2025 23:59:59,123,
/// 12/31/2025 11:59:59 PM, 23:59:59.123.
[[nodiscard]] std::optional<std::int64_t> parse_date(std::string_view field);

/// Splits a line. `separator` ' ' stands for any run of blanks and tabs. Fields in double quotes may hold the
/// separator; the quotes are taken off. Blanks around fields are taken off.
/// \param exact  a blank as separator stands for itself, so that two of them have an empty field between them
void split_fields(std::string_view line, char separator, std::vector<std::string_view>& fields, bool exact = false);

/// The fields of a line of plain CSV, without blanks around them; there are no quotes.
void split_at_commas(std::string_view line, std::vector<std::string_view>& fields);

/// Lines of a text without their ends (LF, CR LF or CR alone); calls `each(line, number)`, number from 1, until it
/// returns false. Returns whether the last line had an end.
template <class Each>
bool for_each_line(std::string_view text, Each each) {
  long number = 0;
  while (!text.empty()) {
    const auto end = text.find_first_of("\r\n");
    if (end == std::string_view::npos) {
      each(text, ++number);
      return false;
    }
    if (!each(text.substr(0, end), ++number)) return true;
    const bool both = text[end] == '\r' && end + 1 < text.size() && text[end + 1] == '\n';
    text.remove_prefix(end + (both ? 2 : 1));
  }
  return true;
}

}  // namespace deltadyn::forms
