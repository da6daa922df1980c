/// \file
/// No file names an effect but its own header, the list and tests: whatever else needs one reads its traits.

#include <cctype>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace deltadyn {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = DELTADYN_SOURCE_DIR;

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Effects that have a second meaning, as terms of the model or of a drive; their words are free outside quotes.
const std::set<std::string> kOtherMeaning = {"presliding",     // the model's own bristles, rows driveK.presliding
                                             "rotor_inertia",  // driveK.rotor_inertia
                                             "payload",        // what a controller carries
                                             "saturation",     // a torque that is cut off in a log
                                             "torque_ripple",  // the model's own waves, rows driveK.rippleI
                                             "backlash",       // play, in texts
                                             "hysteresis"};

/// Of these, the names of rows in parameter files, which are quoted.
const std::set<std::string> kRows = {"presliding", "rotor_inertia"};

struct Named {
  std::string name, type;
};

std::vector<Named> listed_effects() {
  const std::string list = text_of(kRoot / "include/deltadyn/effects/all.hpp");
  std::vector<Named> all;
  const std::regex type("effects::([A-Za-z]+)");
  for (auto it = std::sregex_iterator(list.begin(), list.end(), type); it != std::sregex_iterator(); ++it) {
    const std::string words = (*it)[1];
    std::string name;
    for (const char c : words) {
      if (std::isupper(static_cast<unsigned char>(c)) != 0 && !name.empty()) name += '_';
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    all.push_back({name, words});
  }
  return all;
}

/// Does the word stand in the text, not as a part of another? (std::regex takes minutes for all files and effects.)
bool has_word(const std::string& text, const std::string& word) {
  const auto is_part = [&text](std::size_t at) {
    return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) != 0 || text[at] == '_');
  };
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    if (!(at > 0 && is_part(at - 1)) && !is_part(at + word.size())) return true;
  return false;
}

/// The first word of a text that names an effect, else nothing.
std::string named_in(const std::string& text, const std::vector<Named>& effects) {
  for (const Named& one : effects) {
    if (has_word(text, "effects::" + one.type)) return one.type;
    if (text.find("effects/" + one.name + ".hpp") != std::string::npos) return one.name + ".hpp";
    if (kRows.count(one.name) == 0 && text.find('"' + one.name + '"') != std::string::npos) return '"' + one.name + '"';
    if (kOtherMeaning.count(one.name) == 0 && has_word(text, one.name)) return one.name;
  }
  return {};
}

TEST(EffectNames, StandInTheirHeaderTheListAndTestsOnly) {
  const std::vector<Named> effects = listed_effects();
  ASSERT_GE(effects.size(), 28U);
  int looked_at = 0;
  for (const char* folder : {"include", "src", "tools"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      const std::string ending = entry.path().extension().string();
      if (ending != ".hpp" && ending != ".hxx" && ending != ".cpp") continue;
      if (entry.path().parent_path().filename() == "effects") continue;
      EXPECT_EQ(named_in(text_of(entry.path()), effects), "") << fs::relative(entry.path(), kRoot);
      ++looked_at;
    }
  }
  EXPECT_GT(looked_at, 300);
}

TEST(EffectNames, EachListedEffectHasItsHeaderAndItsTest) {
  for (const Named& one : listed_effects()) {
    EXPECT_TRUE(fs::exists(kRoot / "include/deltadyn/effects" / (one.name + ".hpp"))) << one.name;
    EXPECT_TRUE(fs::exists(kRoot / "tests/effects" / (one.name + "_test.cpp"))) << one.name;
  }
}

TEST(EffectNames, AreFoundWhereTheyStand) {
  const std::vector<Named> effects = {{"hose_force", "HoseForce"}, {"payload", "Payload"}};
  EXPECT_EQ(named_in("if (kind.name == \"payload\")", effects), "\"payload\"");
  EXPECT_EQ(named_in("effect_id<effects::HoseForce>", effects), "HoseForce");
  EXPECT_EQ(named_in("of a hose_force", effects), "hose_force");
  EXPECT_EQ(named_in("set_payload(mass); // payload", effects), "");
}

}  // namespace
}  // namespace deltadyn
