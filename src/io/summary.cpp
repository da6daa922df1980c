#include "deltadyn/io/summary.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

#include "deltadyn/io/output_file.hpp"

namespace deltadyn {

void Summary::add(const std::string& key, double value, const std::string& unit) {
  put(key, fmt::format("{}", value), unit);
}

void Summary::add(const std::string& key, const std::string& value, const std::string& unit) {
  std::string plain = value;
  std::ranges::replace(plain, ',', ';');
  std::ranges::replace_if(
      plain, [](char c) { return c == '\n' || c == '\r'; }, ' ');
  put(key, std::move(plain), unit);
}

void Summary::put(const std::string& key, std::string value, const std::string& unit) {
  const auto found = std::ranges::find(rows_, key, &Row::key);
  if (found == rows_.end()) {
    rows_.push_back({key, std::move(value), unit});
  } else {
    found->value = std::move(value);
    found->unit = unit;
  }
}

void Summary::write(const std::string& path) const {
  if (path.empty()) return;
  std::string text = "key,value,unit\n";
  for (const Row& row : rows_) text += fmt::format("{},{},{}\n", row.key, row.value, row.unit);
  write_file(path, text);
}

}  // namespace deltadyn
