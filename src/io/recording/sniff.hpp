#pragma once

/// \file
/// How a delimited text is laid out: separator, decimal mark, where the names, the units and the rows are.

#include <string>
#include <string_view>
#include <vector>

namespace deltadyn::forms {

struct Layout {
  char separator = ',';  ///< ' ': any run of blanks and tabs
  char decimal = '.';
  std::size_t fields = 0;          ///< of a row
  long first_row = 0;              ///< line of the first row, from 1
  long header_line = 0;            ///< 0: none
  std::vector<std::string> names;  ///< one a field; "column1", ... if there is no header
  std::vector<std::string> units;  ///< one a field from a row of units below the names; empty: no such row
};

/// Looks at the first lines of a text. `path` is for messages.
/// Throws Error(bad_input) if nothing in it looks like rows of numbers, or the names do not fit the rows.
[[nodiscard]] Layout sniff_layout(std::string_view text, const std::string& path);

/// "text separated by ';' with decimal comma"
[[nodiscard]] std::string describe(const Layout& layout);

}  // namespace deltadyn::forms
