#include "field.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace deltadyn::forms {
namespace {

/// Spellings of "no value" in exports of spreadsheets, MATLAB, Microsoft's C library and databases.
bool is_missing_word(std::string_view field) {
  static constexpr std::array kWords = {
      "nan",     "-nan",   "+nan",      "n/a",      "#n/a",      "na",       "null",     "none", "nil",
      "-",       "--",     "inf",       "-inf",     "+inf",      "#nv",      "1.#qnan",  "?",    "1.#ind",
      "-1.#ind", "1.#inf", "-nan(ind)", "nan(ind)", "undefined", "infinity", "-infinity"};
  if (field.size() > 10) return false;
  const std::string word = lower(field);
  return std::ranges::find(kWords, word) != kWords.end();
}

/// Reads the digits of a date one after the other.
class DateScanner {
 public:
  explicit DateScanner(std::string_view text) : text_(text) {}
  [[nodiscard]] bool done() const { return text_.empty(); }
  [[nodiscard]] char next() const { return text_.empty() ? '\0' : text_.front(); }
  bool take(char c) {
    if (next() != c) return false;
    text_.remove_prefix(1);
    return true;
  }
  bool take_any(std::string_view set) {
    if (text_.empty() || set.find(next()) == std::string_view::npos) return false;
    text_.remove_prefix(1);
    return true;
  }
  void skip_blanks() {
    while (take_any(" T\t")) continue;
  }
  /// Digits, at most `most`; how many were there.
  int number(int most, std::int64_t& value) {
    int digits = 0;
    value = 0;
    while (digits < most && is_digit(next())) {
      value = value * 10 + (next() - '0');
      text_.remove_prefix(1);
      ++digits;
    }
    return digits;
  }
  [[nodiscard]] std::string_view rest() const { return text_; }
  void reset(std::string_view text) { text_ = text; }

 private:
  std::string_view text_;
};

/// year-month-day, day.month.year or month/day/year (day/month/year if the first cannot be a month).
bool scan_day(DateScanner& scan, std::int64_t& days) {
  std::int64_t a = 0, b = 0, c = 0;
  const int first = scan.number(4, a);
  const char mark = scan.next();
  if (first == 0 || !scan.take_any("-./") || scan.number(2, b) == 0 || !scan.take(mark)) return false;
  const int last = scan.number(4, c);
  if (last == 0) return false;
  std::int64_t y = c, m = b, d = a;
  if (first == 4) {
    y = a, m = b, d = c;
  } else if (mark == '/' && a <= 12) {
    m = a, d = b;
  }
  if (first != 4 && last == 2) y += 2000;
  // Nanoseconds of other centuries would not fit, and no log is from there.
  if (y < 1970 || y > 2200 || m < 1 || m > 12 || d < 1 || d > 31) return false;
  const std::chrono::sys_days first_of_month = std::chrono::year(static_cast<int>(y)) / static_cast<int>(m) / 1;
  days = first_of_month.time_since_epoch().count() + d - 1;
  return true;
}

/// hour:minute:second with a fraction after '.', ',' or ':', AM or PM, Z or an offset.
bool scan_clock(DateScanner& scan, std::int64_t& ns) {
  std::int64_t h = 0, m = 0, s = 0;
  if (scan.number(2, h) == 0 || !scan.take(':') || scan.number(2, m) != 2) return false;
  std::int64_t fraction = 0;
  if (scan.take(':')) {
    if (scan.number(2, s) != 2) return false;
    if (scan.take_any(".,:")) {
      std::int64_t ignored = 0;
      int digits = scan.number(9, fraction);
      if (digits == 0) return false;
      while (digits++ < 9) fraction *= 10;
      scan.number(12, ignored);
    }
  }
  if (h > 24 || m > 59 || s > 60) return false;
  scan.skip_blanks();
  const std::string half = lower(scan.rest().substr(0, 2));
  if (half == "am" || half == "pm") {
    h = h % 12 + (half == "pm" ? 12 : 0);
    scan.reset(scan.rest().substr(2));
  }
  std::int64_t shift_min = 0;
  if (!scan.take('Z') && (scan.next() == '+' || scan.next() == '-')) {
    const bool west = scan.next() == '-';
    scan.take_any("+-");
    std::int64_t oh = 0, om = 0;
    if (scan.number(2, oh) != 2) return false;
    scan.take(':');
    scan.number(2, om);
    shift_min = (oh * 60 + om) * (west ? -1 : 1);
  }
  ns = (((h * 60 + m - shift_min) * 60 + s) * 1000000000LL) + fraction;
  return true;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

std::string with_each(std::string text, std::string_view from, std::string_view to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

bool parse_decimal(std::string_view text, double& value) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+') text.remove_prefix(1);
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (stop != end || error == std::errc::invalid_argument) return false;
  // from_chars leaves the value alone here: too small reads as zero, too large is no number we can use.
  if (error == std::errc::result_out_of_range) value = std::strtod(std::string(text).c_str(), nullptr);
  if (!std::isfinite(value)) value = kNan;
  return true;
}

bool parse_number(std::string_view field, char decimal, double& value) {
  if (field.empty()) {
    value = kNan;
    return true;
  }
  if (decimal == '.') {
    if (parse_decimal(field, value)) return true;
  } else if (field.find('.') == std::string_view::npos && field.size() < 64) {
    std::array<char, 64> buffer{};
    std::memcpy(buffer.data(), field.data(), field.size());
    if (char* comma = static_cast<char*>(std::memchr(buffer.data(), ',', field.size()))) *comma = '.';
    if (parse_decimal({buffer.data(), field.size()}, value)) return true;
  }
  if (!is_missing_word(field)) return false;
  value = kNan;
  return true;
}

Field parse_field(std::string_view field, char decimal, double& value) {
  if (parse_number(field, decimal, value)) return std::isnan(value) ? Field::missing : Field::number;
  if (field.size() <= 5) {
    const std::string word = lower(field);
    if (word == "true" || word == "false") {
      value = word == "true" ? 1.0 : 0.0;
      return Field::number;
    }
  }
  return parse_date(field) ? Field::date : Field::text;
}

std::optional<std::int64_t> long_integer(std::string_view field) {
  if (field.size() < 16) return std::nullopt;
  std::int64_t value = 0;
  const auto [stop, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  constexpr std::int64_t kLargest = 4000000000000000000LL;  // differences must fit, too
  if (error != std::errc() || stop != field.data() + field.size() || std::abs(value) > kLargest) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_date(std::string_view field) {
  if (field.size() < 5 || field.size() > 40 || !is_digit(field.front())) return std::nullopt;
  constexpr std::int64_t kDay = 86400LL * 1000000000LL;
  DateScanner scan(field);
  std::int64_t days = 0, ns = 0;
  const bool dated = scan_day(scan, days);
  if (!dated) {
    days = 0;
    scan.reset(field);
  }
  scan.skip_blanks();
  scan.take(',');
  scan.skip_blanks();
  if (scan.done()) return dated ? std::optional(days * kDay) : std::nullopt;
  if (!scan_clock(scan, ns) || !scan.done()) return std::nullopt;
  return days * kDay + ns;
}

void split_fields(std::string_view line, char separator, std::vector<std::string_view>& fields, bool exact) {
  fields.clear();
  const bool blanks = separator == ' ' && !exact;
  if (blanks) line = trimmed(line);
  for (;;) {
    std::string_view rest = line;
    while (!rest.empty() && rest.front() != separator && (rest.front() == ' ' || rest.front() == '\t'))
      rest.remove_prefix(1);
    const auto close = rest.starts_with('"') ? rest.find('"', 1) : std::string_view::npos;
    const bool quoted = close != std::string_view::npos;
    if (quoted) {
      fields.push_back(trimmed(rest.substr(1, close - 1)));
      line = rest.substr(close + 1);
    }
    const auto end = blanks ? line.find_first_of(" \t") : line.find(separator);
    if (!quoted) fields.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return;
    line.remove_prefix(end + 1);
    if (blanks) line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  }
}

void split_at_commas(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  for (;;) {
    const auto comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return;
    line.remove_prefix(comma + 1);
  }
}

}  // namespace deltadyn::forms
