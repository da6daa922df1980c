#pragma once

/// \file
/// The figures a tool prints, as CSV `key,value,unit` (flag --summary of every tool).

#include <concepts>
#include <string>
#include <vector>

namespace deltadyn {

class Summary {
 public:
  struct Row {
    std::string key, value, unit;
  };

  /// Adds a row, or replaces the value of a key that is there already (its place stays).
  /// Numbers are written so that they read back exactly. `unit` is "" for counts, ratios and words.
  void add(const std::string& key, double value, const std::string& unit = "");
  void add(const std::string& key, std::integral auto value, const std::string& unit = "") {
    put(key, std::to_string(value), unit);
  }
  /// Commas and line ends in the text, which CSV without quotes cannot hold, become ';' and blanks.
  void add(const std::string& key, const std::string& value, const std::string& unit = "");
  void add(const std::string& key, const char* value, const std::string& unit = "") {
    add(key, std::string(value), unit);
  }

  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  /// Does nothing if `path` is empty (the flag was not given). Throws Error(bad_input) if it cannot write.
  void write(const std::string& path) const;

 private:
  void put(const std::string& key, std::string value, const std::string& unit);
  std::vector<Row> rows_;
};

}  // namespace deltadyn
