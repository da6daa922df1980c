#include "deltadyn/report/format.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <utility>

namespace deltadyn {
namespace {

constexpr const char* kNarrowSpace = "\u202F";
constexpr int kLowestPlainExponent = -4;  // 0.0001 is still written out
constexpr int kHighestPlainExponent = 5;  // and so is 999999

bool plain(int exponent) {
  return exponent >= kLowestPlainExponent && exponent <= kHighestPlainExponent;
}

/// Power of ten of the first digit after rounding to so many digits: 9.996 with three digits is 1.00e1.
int exponent_of(double value, int digits) {
  if (value == 0.0) return 0;
  const std::string text = fmt::format("{:.{}e}", std::abs(value), digits - 1);
  return std::atoi(text.c_str() + text.find('e') + 1);
}

/// With so many digits behind the point; a negative count rounds in front of it. Never "-0.00".
std::string fixed(double value, int decimals) {
  if (decimals < 0) {
    const double unit = std::pow(10.0, -decimals);
    value = std::round(value / unit) * unit;
  }
  std::string text = fmt::format("{:.{}f}", value, std::max(decimals, 0));
  if (text[0] == '-' && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

std::string times_ten_to(int exponent) {
  static constexpr std::array<const char*, 10> kSuperscript{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string result = " × 10";
  for (const char c : std::to_string(exponent))
    result += c == '-' ? "⁻" : kSuperscript[static_cast<std::size_t>(c - '0')];
  return result;
}

/// value / 10^exponent; in two steps because 10^-310 is not a normal number.
double scaled(double value, int exponent) {
  const int half = exponent / 2;
  return value / std::pow(10.0, half) / std::pow(10.0, exponent - half);
}

std::string with_unit(std::string text, std::string_view unit) {
  if (unit.empty() || unit == "1" || unit == "-") return text;
  return std::move(text) + " " + pretty_unit(unit);
}

std::string not_finite(double value) {
  if (std::isnan(value)) return "–";
  return value > 0.0 ? "∞" : "-∞";
}

}  // namespace

std::string format_number(double value, int significant_digits) {
  if (!std::isfinite(value)) return not_finite(value);
  const int digits = std::max(significant_digits, 1);
  if (value == 0.0) return "0";
  const int exponent = exponent_of(value, digits);
  if (plain(exponent)) return fixed(value, digits - 1 - exponent);
  return fixed(scaled(value, exponent), digits - 1) + times_ten_to(exponent);
}

std::string format_number(double value, std::string_view unit, int significant_digits) {
  return with_unit(format_number(value, significant_digits), unit);
}

std::string format_with_uncertainty(double value, double uncertainty, std::string_view unit) {
  if (!std::isfinite(value) || std::isnan(uncertainty) || uncertainty < 0.0)
    return with_unit(format_number(value, 4), unit);
  if (std::isinf(uncertainty)) return with_unit(format_number(value, 4) + " ± ∞", unit);
  if (uncertainty == 0.0) return with_unit(fmt::format("{:.6g}", value), unit);
  const int last_digit = exponent_of(uncertainty, 2) - 1;
  const int exponent = std::max(exponent_of(value, 2), last_digit + 1);
  // A value of 1.2 with an uncertainty of 3e-8 needs its eight decimals; a power of ten helps only where the first
  // digit is far.
  if (plain(exponent) && last_digit < 3)
    return with_unit(fixed(value, -last_digit) + " ± " + fixed(uncertainty, -last_digit), unit);
  const int decimals = exponent - last_digit;
  return with_unit(fmt::format("({} ± {}){}", fixed(scaled(value, exponent), decimals),
                               fixed(scaled(uncertainty, exponent), decimals), times_ten_to(exponent)),
                   unit);
}

std::string format_estimate(double value, double uncertainty, std::string_view unit) {
  // An interval that dwarfs the value must not hide it: 0.2 ± 30, not 0 ± 30.
  if (value != 0.0 && std::isfinite(value) && std::isfinite(uncertainty) && uncertainty > std::abs(value))
    return with_unit(format_number(value, 2) + " ± " + format_number(uncertainty, 2), unit);
  return format_with_uncertainty(value, uncertainty, unit);
}

std::string format_interval(double low, double high, std::string_view unit) {
  const double length = high - low;
  if (!std::isfinite(length) || length <= 0.0)
    return with_unit(format_number(low, 4) + " … " + format_number(high, 4), unit);
  const double largest = std::max(std::abs(low), std::abs(high));
  const int exponent = exponent_of(largest, 3);
  const int last_digit = exponent_of(length, 1) - 2;
  if (plain(exponent)) return with_unit(fixed(low, -last_digit) + " … " + fixed(high, -last_digit), unit);
  const int decimals = std::max(exponent - last_digit, 0);
  return with_unit(fmt::format("({} … {}){}", fixed(scaled(low, exponent), decimals),
                               fixed(scaled(high, exponent), decimals), times_ten_to(exponent)),
                   unit);
}

std::string format_percent(double fraction, int significant_digits) {
  return format_number(100.0 * fraction, significant_digits) + " %";
}

std::string format_count(long long count) {
  std::string digits = std::to_string(count);
  const std::size_t first = digits[0] == '-' ? 1 : 0;
  for (std::size_t place = digits.size(); place > first + 3;) {
    place -= 3;
    digits.insert(place, kNarrowSpace);
  }
  return digits;
}

std::string format_duration(double seconds) {
  if (!std::isfinite(seconds)) return not_finite(seconds);
  if (seconds < 0.0) return "-" + format_duration(-seconds);
  if (seconds < 0.9995e-3) return format_number(seconds * 1e6, 3) + " µs";
  if (seconds < 0.9995) return format_number(seconds * 1e3, 3) + " ms";
  if (seconds < 99.95) return format_number(seconds, 3) + " s";
  const auto whole = static_cast<long long>(std::llround(std::min(seconds, 1e15)));
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

std::string pretty_unit(std::string_view unit) {
  // The names of columns cannot hold a stroke: there the parts behind the first are divisors, except after kg.
  static constexpr std::pair<std::string_view, const char*> kColumnUnits[] = {{"Nm", "N m"},
                                                                              {"Nms", "N m s"},
                                                                              {"rad_s", "rad/s"},
                                                                              {"rad_s2", "rad/s²"},
                                                                              {"m_s", "m/s"},
                                                                              {"m_s2", "m/s²"},
                                                                              {"deg_s", "deg/s"},
                                                                              {"kg_m", "kg m"},
                                                                              {"kg_m2", "kg m²"},
                                                                              {"kgm2", "kg m²"},
                                                                              {"Nm_s_rad", "N m s/rad"},
                                                                              {"N_s_m", "N s/m"},
                                                                              {"Nms/rad", "N m s/rad"},
                                                                              {"percent", "%"}};
  for (const auto& [plain_name, text] : kColumnUnits)
    if (unit == plain_name) return text;

  std::string result(unit);
  for (const auto& [from, to] : {std::pair<std::string_view, std::string_view>{"*", " "},
                                 {"^2", "²"},
                                 {"^3", "³"},
                                 {"^-1", "⁻¹"},
                                 {"^-2", "⁻²"}}) {
    for (auto at = result.find(from); at != std::string::npos; at = result.find(from))
      result.replace(at, from.size(), to);
  }
  return result;
}

}  // namespace deltadyn
