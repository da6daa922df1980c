#pragma once

/// \file
/// Numbers for people: as many digits as are meaningful, with uncertainty and unit. Text is UTF-8.

#include <string>
#include <string_view>

namespace deltadyn {

/// A number with this many significant digits, e.g. 0.01235, 12300, "1.2 × 10⁻⁵"; "–" for NaN, "∞" for infinity.
/// The power of ten is written out below 1e-4 and from 1e6 on.
[[nodiscard]] std::string format_number(double value, int significant_digits = 4);

/// A number with its unit, e.g. "12.35 N m".
[[nodiscard]] std::string format_number(double value, std::string_view unit, int significant_digits = 4);

/// Value and standard uncertainty, e.g. "1.234 ± 0.012 kg", "(1.23 ± 0.12) × 10⁻⁵ kg m²". The uncertainty has two
/// significant digits and the value ends at the same place. An uncertainty of 0 means exact, a NaN or negative one
/// means unknown: then the value stands alone, with four significant digits if unknown.
[[nodiscard]] std::string format_with_uncertainty(double value, double uncertainty, std::string_view unit = "");

/// The same, but an uncertainty larger than the value does not round it away: "0.20 ± 30".
[[nodiscard]] std::string format_estimate(double value, double uncertainty, std::string_view unit = "");

/// An interval with matching digits, e.g. "1.21 … 1.26 kg"; the ends are given to a hundredth of the interval's length.
[[nodiscard]] std::string format_interval(double low, double high, std::string_view unit = "");

/// 0.01234 -> "1.23 %".
[[nodiscard]] std::string format_percent(double fraction, int significant_digits = 3);

/// A count with groups of three digits, e.g. "1 234 567" (narrow no-break spaces).
[[nodiscard]] std::string format_count(long long count);

/// A time in the unit that suits it, e.g. "3.2 ms", "12.5 s", "2 min 5 s".
[[nodiscard]] std::string format_duration(double seconds);

/// A unit as people write it, from a column name or a file: "Nm" -> "N m", "rad_s2" -> "rad/s²", "kg m^2" -> "kg m²",
/// "N*m*s/rad" -> "N m s/rad", "kg_m2" -> "kg m²". What it does not know stays as it is.
[[nodiscard]] std::string pretty_unit(std::string_view unit);

}  // namespace deltadyn
