#pragma once

/// \file
/// Texts of other programs as UTF-8.

#include <string>
#include <string_view>

namespace deltadyn {

struct DecodedText {
  std::string text;  ///< UTF-8 without byte-order mark
  /// It was no UTF-8, so each byte was taken as a character of Windows-1252 (Latin-1 with more)
  bool is_windows_1252 = false;
};

/// Length of the UTF-8 character at the beginning of a text; 0 if there is none (surrogates and overlong forms are
/// none).
[[nodiscard]] std::size_t utf8_length(std::string_view text);

/// UTF-8 and UTF-16 by their byte-order marks, UTF-8 without one, and what is none of these as Windows-1252.
[[nodiscard]] DecodedText decode_text(std::string bytes);

}  // namespace deltadyn
