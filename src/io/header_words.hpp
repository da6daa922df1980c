#pragma once

/// \file
/// What the name of a column says: quantity, measured or commanded, numbers.

#include <optional>
#include <string>
#include <vector>

#include "deltadyn/io/log_units.hpp"

namespace deltadyn {

enum class Origin { commanded, unstated, measured };

struct HeaderWords {
  std::string stem, unit;
  std::optional<Quantity> quantity;  ///< from words, or from the unit where it says enough
  Origin origin = Origin::unstated;
  bool excluded = false;  ///< errors, limits, temperatures, Cartesian poses: no channel of a drive
  std::string pattern;    ///< words with '#' for each number: alike for the drives of a machine
  std::vector<long> numbers;
};

/// \param unit  the one the recording states, may be empty
[[nodiscard]] HeaderWords read_header_words(const std::string& column, const std::string& unit);

/// Words of a name in lower case, split at marks, at digits and at capitals: "MAIN.Axis1.ActPos" -> main axis 1 act
/// pos.
[[nodiscard]] std::vector<std::string> words_of(const std::string& name);

}  // namespace deltadyn
