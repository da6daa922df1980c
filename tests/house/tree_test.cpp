// The tree itself keeps the rules of the house.

#include <gtest/gtest.h>

#include "house/tree_rules.hpp"

namespace deltadyn::house {
namespace {

const std::filesystem::path kRoot = DELTADYN_SOURCE_DIR;

TEST(Tree, EveryFileKeepsTheRules) {
  const auto files = read_tree(kRoot, {"include", "src", "tools", "tests"});
  int in_core = 0;
  Findings findings;
  for (const SourceFile& file : files) {
    in_core += is_core(file.path) ? 1 : 0;
    for (const Finding& finding : check(file)) findings.push_back(finding);
  }
  EXPECT_GT(in_core, 5) << "the walk over the tree misses the core";
  EXPECT_TRUE(findings.empty()) << to_string(findings);
}

TEST(Tree, TopFolderHoldsOnlyWhatTheDesignNames) {
  std::vector<std::string> entries;
  for (const auto& entry : std::filesystem::directory_iterator(kRoot))
    entries.push_back(entry.path().filename().string());
  ASSERT_FALSE(entries.empty());
  EXPECT_EQ(to_string(check_top_level(entries)), "");
}

// The list of core folders stands twice, here and in CMakeLists.txt; the two must not drift apart.
TEST(Tree, CMakeAndTheRulesAgreeOnTheCore) {
  std::ifstream stream(kRoot / "CMakeLists.txt");
  const std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  std::string expected = "set(DELTADYN_CORE_FLOORS";
  for (int i = 0; i <= floor_number("firmware"); ++i) expected += " " + floors()[static_cast<std::size_t>(i)];
  EXPECT_NE(text.find(expected + ")"), std::string::npos) << "CMakeLists.txt should hold: " << expected << ")";
}

}  // namespace
}  // namespace deltadyn::house
