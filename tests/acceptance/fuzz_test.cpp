// Damaged files must never crash a tool or make it hang: whatever happens, it ends with one of its own exit codes.

#include <algorithm>
#include <gtest/gtest.h>
#include <random>
#include <set>

#include "acceptance/workshop.hpp"

namespace deltadyn::acceptance {
namespace {

class Damage {
 public:
  explicit Damage(std::uint64_t seed) : engine_(seed) {}

  /// One to four changes of a kind that broken disks, editors and loggers make.
  std::string apply(std::string text) {
    const std::size_t changes = 1 + below(4);
    for (std::size_t k = 0; k < changes; ++k) one(text);
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(engine_() % n); }

  void one(std::string& text) {
    static const char* const kPieces[] = {",", "\n",  "nan", "-",    "1e308", "1e-320", "\"", "<",
                                          ">", "inf", "0",   "\xff", "e",     ".",      "\r"};
    const std::size_t at = below(text.size());
    switch (below(7)) {
      case 0: text.resize(at); break;                                      // cut off
      case 1: text.erase(at, 1 + below(80)); break;                        // a piece lost
      case 2: text.insert(at, kPieces[below(std::size(kPieces))]); break;  // a piece too much
      case 3:                                                              // a byte changed
        if (!text.empty()) text[at] = static_cast<char>(below(256));
        break;
      case 4: text.insert(at, text.substr(below(text.size()), below(200))); break;  // a piece twice
      case 5: change_number(text, at); break;
      default: swap_lines(text); break;
    }
  }

  /// Replaces the next number in the text.
  void change_number(std::string& text, std::size_t at) {
    static const char* const kNumbers[] = {
        "0", "-1", "1e9", "-0.0", "1e300", "nan", "3.5", "1e-9", "99999999999999999999"};
    const std::size_t begin = text.find_first_of("0123456789", at);
    if (begin == std::string::npos) return;
    const std::size_t end = std::min(text.size(), text.find_first_not_of("0123456789.e-", begin));
    text.replace(begin, end - begin, kNumbers[below(std::size(kNumbers))]);
  }

  void swap_lines(std::string& text) {
    Lines lines = to_lines(text);
    if (lines.size() < 2) return;
    std::swap(lines[below(lines.size())], lines[below(lines.size())]);
    text = to_text(lines);
  }

  std::mt19937_64 engine_;
};

constexpr int kCases = 200;

/// Runs the command on damaged copies of a text. \return how many of them were refused
int survive(std::uint64_t seed, const std::string& good,
            const std::function<Words(const Workshop&, const std::string&)>& command, const std::string& name) {
  Damage damage(seed);
  const Workshop workshop;
  int refused = 0;
  for (int k = 0; k < kCases; ++k) {
    const std::string text = damage.apply(good);
    const std::string file = workshop.write(name, text);
    const auto before = contents(workshop.folder());
    const ToolResult result = run(command(workshop, file), {20});
    const std::set<int> allowed = {0, 2, 3, 4, 5};
    EXPECT_EQ(allowed.count(result.code), 1U)
        << "case " << k << " of seed " << seed << " ended with " << result.code << "\n"
        << result.out << result.err;
    // An exception that nobody foresaw has no advice for the user.
    EXPECT_EQ(result.err.find("unexpected error"), std::string::npos) << "case " << k << " of seed " << seed << "\n"
                                                                      << result.err;
    if (result.code != 0) {
      ++refused;
      EXPECT_FALSE(result.err.empty()) << "case " << k << " of seed " << seed << " says nothing";
      if (result.code != 5) {
        EXPECT_EQ(contents(workshop.folder()), before) << "case " << k << " of seed " << seed << " left files behind";
      }
    }
    for (const char* output : {"out.csv", "base.csv", "summary.csv"}) fs::remove(workshop.path(output));
    for (const auto& [left, bytes] : contents(workshop.folder()))
      EXPECT_EQ(left.find(".tmp"), std::string::npos) << left;
    if (::testing::Test::HasFailure()) break;
  }
  return refused;
}

Lines short_log() {
  Lines lines = Workshop::good_log();
  lines.resize(700);
  return lines;
}

TEST(Fuzz, DamagedLogs) {
  const int refused = survive(
      1, to_text(short_log()), [](const Workshop& w, const std::string& file) { return w.validate(file); }, "fuzz.csv");
  // Damage that no check sees would make this test blind, and so would a tool that refuses everything.
  EXPECT_GT(refused, kCases / 4);
  EXPECT_LT(refused, kCases);
}

TEST(Fuzz, DamagedLogsForIdentification) {
  const int refused = survive(
      2, to_text(short_log()), [](const Workshop& w, const std::string& file) { return w.identify(file); }, "fuzz.csv");
  EXPECT_GT(refused, kCases / 4);
}

TEST(Fuzz, DamagedRobots) {
  const int refused = survive(
      3, to_text(Workshop::robot()), [](const Workshop& w, const std::string& file) { return w.validate("", file); },
      "fuzz.urdf");
  EXPECT_GT(refused, kCases / 4);
  EXPECT_LT(refused, kCases);
}

TEST(Fuzz, DamagedParameters) {
  const int refused = survive(
      4, to_text(Workshop::prior()),
      [](const Workshop& w, const std::string& file) { return w.validate("", "", file); }, "fuzz.csv");
  EXPECT_GT(refused, kCases / 8);
  EXPECT_LT(refused, kCases);
}

}  // namespace
}  // namespace deltadyn::acceptance
