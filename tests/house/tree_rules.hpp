#pragma once

/// \file
/// The rules of the house, as functions on a path and a text, so that they can be tried on made-up offenders.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace deltadyn::house {

/// One source file: its path from the top of the tree ("include/deltadyn/core/types.hpp") and its content.
struct SourceFile {
  std::string path;
  std::string text;
};

/// One breach of a rule.
struct Finding {
  std::string path;
  int line = 0;  ///< from 1; 0 if the whole file is meant
  std::string message;
};

using Findings = std::vector<Finding>;

inline constexpr int kMaxHeaderLines = 400;
inline constexpr int kMaxSourceLines = 700;
inline constexpr int kMaxColumns = 120;

/// From the lowest to the highest.
inline const std::vector<std::string>& floors() {
  static const std::vector<std::string> names = {
      "core",       "model",      "kinematics",     "effects",   "dynamics",   "firmware", "runtime", "signal",
      "trajectory", "excitation", "identification", "diagnosis", "simulation", "robots",   "io",      "report"};
  return names;
}

/// Number of a floor from 0, -1 if the folder is none.
inline int floor_number(std::string_view folder) {
  const auto found = std::find(floors().begin(), floors().end(), folder);
  return found == floors().end() ? -1 : static_cast<int>(found - floors().begin());
}

/// First folder below include/deltadyn/ or src/; empty for a file elsewhere or directly in one of the two.
inline std::string floor_of(std::string_view path) {
  for (const std::string_view top : {"include/deltadyn/", "src/"}) {
    if (path.substr(0, top.size()) != top) continue;
    path.remove_prefix(top.size());
    const auto slash = path.find('/');
    return slash == std::string_view::npos ? "" : std::string(path.substr(0, slash));
  }
  return "";
}

inline bool is_core(std::string_view path) {
  const int floor = floor_number(floor_of(path));
  return floor >= 0 && floor <= floor_number("firmware");
}

enum class Literals { keep, blank };

/// The text with comments, and if wanted the content of literals, turned to blanks. Line numbers stay.
inline std::string without_comments(std::string_view text, Literals literals) {
  std::string out(text);
  const auto blank = [&out](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < std::min(to, out.size()); ++i) {
      if (out[i] != '\n') out[i] = ' ';
    }
  };
  const auto end_of = [&text](std::string_view mark, std::size_t from) {
    const auto at = text.find(mark, from);
    return at == std::string_view::npos ? text.size() : at + mark.size();
  };
  const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  for (std::size_t i = 0; i < text.size();) {
    const std::string_view rest = text.substr(i);
    std::size_t next = i + 1;
    if (rest.substr(0, 2) == "//") {
      next = std::min(text.find('\n', i), text.size());
      blank(i, next);
    } else if (rest.substr(0, 2) == "/*") {
      next = end_of("*/", i + 2);
      blank(i, next);
    } else if (rest.substr(0, 2) == "R\"" && rest.find('(') != std::string_view::npos) {
      const std::string closing = ")" + std::string(rest.substr(2, rest.find('(') - 2)) + "\"";
      next = end_of(closing, i + 2);
      if (literals == Literals::blank) blank(i + 2, next - 1);
    } else if (text[i] == '"' || (text[i] == '\'' && (i == 0 || !is_word(text[i - 1])))) {  // 1'000 is no character
      while (next < text.size() && text[next] != text[i] && text[next] != '\n') next += text[next] == '\\' ? 2 : 1;
      next = std::min(next + 1, text.size());
      if (literals == Literals::blank) blank(i + 1, next - 1);
    }
    i = next;
  }
  return out;
}

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

struct Include {
  int line;
  std::string target;  ///< without <> or ""
};

inline std::vector<Include> includes_of(const SourceFile& file) {
  static const std::regex pattern(R"re(^\s*#\s*include\s*[<"]([^>"]+)[>"])re");
  std::vector<Include> includes;
  const auto lines = lines_of(without_comments(file.text, Literals::keep));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::smatch match;
    if (std::regex_search(lines[i], match, pattern)) includes.push_back({static_cast<int>(i) + 1, match[1]});
  }
  return includes;
}

/// A folder includes only its own floor and those below it; robots/, which only instantiates, also their insides.
inline Findings check_floor_includes(const SourceFile& file) {
  Findings findings;
  const std::string folder = floor_of(file.path);
  if (folder.empty()) return findings;
  const int floor = floor_number(folder);
  if (floor < 0) return {{file.path, 0, "the folder '" + folder + "' is no floor of the house"}};
  static const std::regex pattern("(?:.*/)?deltadyn/([^/]+)(/.*)?");
  for (const Include& include : includes_of(file)) {
    std::smatch match;
    if (!std::regex_match(include.target, match, pattern)) {
      const auto resolved = (std::filesystem::path(file.path).parent_path() / include.target).lexically_normal();
      const std::string other = floor_of(resolved.generic_string());
      const bool instantiates = folder == "robots" && floor_number(other) >= 0 && floor_number(other) < floor;
      if (include.target.find("..") != std::string::npos && other != folder && !instantiates) {
        findings.push_back(
            {file.path, include.line, "includes '" + include.target + "' around the floors; write deltadyn/..."});
      }
      continue;
    }
    const int target = match[2].matched ? floor_number(match[1].str()) : static_cast<int>(floors().size());
    if (target < 0 || target > floor) {
      findings.push_back(
          {file.path, include.line, "the floor '" + folder + "' must not include '" + include.target + "'"});
    }
  }
  return findings;
}

/// Down to firmware/: nothing that brings heap, exceptions, run-time types or streams.
inline Findings check_core(const SourceFile& file) {
  Findings findings;
  if (!is_core(file.path)) return findings;
  static const std::vector<std::string> banned_headers = {"any",           "chrono",          "condition_variable",
                                                          "deque",         "exception",       "filesystem",
                                                          "forward_list",  "fstream",         "functional",
                                                          "future",        "iomanip",         "ios",
                                                          "iosfwd",        "iostream",        "istream",
                                                          "list",          "locale",          "map",
                                                          "memory",        "memory_resource", "mutex",
                                                          "new",           "ostream",         "queue",
                                                          "random",        "regex",           "set",
                                                          "shared_mutex",  "sstream",         "stack",
                                                          "stdexcept",     "streambuf",       "string",
                                                          "thread",        "typeindex",       "typeinfo",
                                                          "unordered_map", "unordered_set",   "valarray",
                                                          "vector",        "cstdio",          "cstdlib",
                                                          "stdio.h",       "stdlib.h",        "malloc.h",
                                                          "Eigen/Sparse",  "Eigen/StdVector"};
  for (const Include& include : includes_of(file)) {
    if (std::find(banned_headers.begin(), banned_headers.end(), include.target) != banned_headers.end()) {
      findings.push_back({file.path, include.line, "the firmware core must not include <" + include.target + ">"});
    }
  }
  static const std::regex pattern(
      R"((^|[^\w])(new|throw|try|catch|dynamic_cast|typeid|malloc|calloc|realloc|free|alloca|goto|Eigen::Dynamic)"
      R"(|(?:Eigen::)?(?:Matrix|Vector|RowVector|Array)X[X\d]?(?:[ifd]|c[fd])?|)"
      R"(std::(?:string|vector|map|function|cout|cerr))(?![\w]))");
  static const std::regex deletion(R"((^|[^\w=\s])\s*delete\s*(\[\s*\])?\s*\w)");
  const auto lines = lines_of(without_comments(file.text, Literals::blank));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].find('#') != std::string::npos && lines[i].find("include") != std::string::npos) continue;
    std::smatch match;
    if (std::regex_search(lines[i], match, pattern)) {
      findings.push_back(
          {file.path, static_cast<int>(i) + 1, "the firmware core must not use '" + match[2].str() + "'"});
    } else if (std::regex_search(lines[i], match, deletion)) {
      findings.push_back({file.path, static_cast<int>(i) + 1, "the firmware core must not use 'delete'"});
    }
  }
  return findings;
}

/// Ceres, NLopt and urdfdom each in the one source folder that wraps it. Tests may use them as oracles.
inline Findings check_wrapped_libraries(const SourceFile& file) {
  if (file.path.compare(0, 6, "tests/") == 0) return {};
  static const std::vector<std::pair<std::regex, std::string>> homes = {
      {std::regex("(ceres|glog)/.*"), "src/identification/"},
      {std::regex(R"(nlopt\.(h|hpp))"), "src/excitation/"},
      {std::regex("(urdf_parser|urdf_model|urdf_exception|urdf_world|urdf_sensor)/.*"), "src/io/"}};
  Findings findings;
  for (const Include& include : includes_of(file)) {
    for (const auto& [pattern, home] : homes) {
      if (std::regex_match(include.target, pattern) && file.path.compare(0, home.size(), home) != 0) {
        findings.push_back({file.path, include.line, "only " + home + " may include '" + include.target + "'"});
      }
    }
  }
  return findings;
}

/// Loops on several threads stand in one file, which passes exceptions on; all others call its functions. Tests may do
/// as they like.
inline Findings check_threads(const SourceFile& file) {
  if (file.path.compare(0, 6, "tests/") == 0 || file.path == "src/runtime/in_parallel.cpp") return {};
  static const std::regex pattern(R"re(^\s*#\s*pragma\s+omp\b)re");
  Findings findings;
  const auto lines = lines_of(without_comments(file.text, Literals::blank));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (std::regex_search(lines[i], pattern)) {
      findings.push_back({file.path, static_cast<int>(i) + 1, "use in_parallel() of deltadyn/runtime/in_parallel.hpp"});
    }
  }
  return findings;
}

/// Headers up to 400 lines, all else up to 700, lines up to 120 characters; headers guard themselves.
inline Findings check_shape(const SourceFile& file) {
  Findings findings;
  const std::string extension = std::filesystem::path(file.path).extension().string();
  const int limit = extension == ".hpp" ? kMaxHeaderLines : kMaxSourceLines;
  const auto lines = static_cast<int>(lines_of(file.text).size());
  if (lines > limit) {
    findings.push_back(
        {file.path, 0, std::to_string(lines) + " lines, more than " + std::to_string(limit) + ": split it"});
  }
  const auto is_first_byte = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; };  // of a character
  for (int line = 1; const std::string& text : lines_of(file.text)) {
    if (std::ranges::count_if(text, is_first_byte) > kMaxColumns) {
      findings.push_back({file.path, line, "more than " + std::to_string(kMaxColumns) + " characters: break the line"});
    }
    ++line;
  }
  if (extension != ".cpp" && file.text.find("#pragma once") == std::string::npos) {
    findings.push_back({file.path, 0, "a header needs #pragma once"});
  }
  return findings;
}

/// All rules for one file.
inline Findings check(const SourceFile& file) {
  Findings all;
  for (const auto rule : {check_floor_includes, check_core, check_wrapped_libraries, check_threads, check_shape}) {
    for (Finding& finding : rule(file)) all.push_back(std::move(finding));
  }
  return all;
}

/// Entries of the top folder that have no place there. Build trees (build, build-x) are never committed and do not
/// count.
inline Findings check_top_level(const std::vector<std::string>& entries) {
  static const std::vector<std::string> allowed = {"CMakeLists.txt",
                                                   "CMakePresets.json",
                                                   "CMakeUserPresets.json",
                                                   "LICENSE",
                                                   "README.md",
                                                   "data",
                                                   "include",
                                                   "src",
                                                   "tests",
                                                   "tools"};
  Findings findings;
  for (const std::string& entry : entries) {
    const bool dotfile = entry.front() == '.';
    const bool build_tree = entry == "build" || entry.compare(0, 6, "build-") == 0;
    if (dotfile || build_tree || std::find(allowed.begin(), allowed.end(), entry) != allowed.end()) continue;
    findings.push_back({entry, 0, "has no place in the top folder"});
  }
  return findings;
}

/// Every C++ file below the given folders of a tree.
inline std::vector<SourceFile> read_tree(const std::filesystem::path& root, const std::vector<std::string>& folders) {
  std::vector<SourceFile> files;
  for (const std::string& folder : folders) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension().string();
      if (!entry.is_regular_file() || (extension != ".hpp" && extension != ".hxx" && extension != ".cpp")) continue;
      std::ifstream stream(entry.path(), std::ios::binary);
      if (!stream) throw std::runtime_error("cannot read " + entry.path().string());
      files.push_back({entry.path().lexically_relative(root).generic_string(),
                       std::string(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>())});
    }
  }
  return files;
}

/// One line a finding, for test messages.
inline std::string to_string(const Findings& findings) {
  std::string text;
  for (const Finding& finding : findings) {
    text += finding.path + (finding.line > 0 ? ":" + std::to_string(finding.line) : "") + ": " + finding.message + "\n";
  }
  return text;
}

}  // namespace deltadyn::house
