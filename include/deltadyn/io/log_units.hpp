#pragma once

/// \file
/// Units as recorders write them.

#include <optional>
#include <string>
#include <string_view>

namespace deltadyn {

enum class Quantity { position, velocity, acceleration, torque };

/// "position", "velocity", "acceleration", "torque"
[[nodiscard]] const char* word_of(Quantity quantity);
[[nodiscard]] std::optional<Quantity> quantity_of_word(std::string_view word);

/// What a unit measures: along with the drive's constants it says how to come to SI.
enum class Dimension {
  angle,          ///< factor to rad, rad/s, rad/s^2
  length,         ///< factor to m, m/s, m/s^2
  counts,         ///< of an encoder; needs counts per turn
  moment,         ///< factor to N m
  force,          ///< factor to N
  current,        ///< factor to A; needs a torque constant
  share_of_rated  ///< factor to 1; needs the rated torque
};

struct LogUnit {
  Quantity quantity;
  Dimension dimension;
  double factor;
};

/// Accepts "deg", "[deg/s]", "rad_s", "1/min", "mNm", "0.1%", "cnt", ... in any case; nothing if unknown.
[[nodiscard]] std::optional<LogUnit> log_unit(std::string_view text);

/// Seconds in a unit of time, "s", "ms", "us", "ns", "min", "filetime" (100 ns).
[[nodiscard]] std::optional<double> time_unit_s(std::string_view text);

/// A column's name without its unit, and the unit: "q1 [rad]", "Torque (Nm)", "q1_rad_s", "t / s". Unit empty if there
/// is none.
struct NameAndUnit {
  std::string stem, unit;
};
[[nodiscard]] NameAndUnit split_unit(const std::string& column);

/// For messages: "rad, deg, turns, m, mm, cnt".
[[nodiscard]] const char* units_of(Quantity quantity);

}  // namespace deltadyn
