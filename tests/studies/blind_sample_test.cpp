// A seeded sample of the blind study; the whole of it runs by blind_study.

#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>

#include "studies/blind_case.hpp"
#include "studies/blind_summary.hpp"

namespace deltadyn::blind {
namespace {

constexpr int kNullRuns = 40;  // enough for the plain cases of the sample

int index_of(const std::string& name) {
  const auto& names = hidden_names();
  return static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
}

class BlindEffect : public testing::TestWithParam<const char*> {};

TEST_P(BlindEffect, IsNamedAtItsPlace) {
  const Outcome outcome = run_case("effects", index_of(GetParam()), kNullRuns);
  ASSERT_FALSE(outcome.named.empty()) << to_line(GetParam(), outcome);
  EXPECT_EQ(split(outcome.named).front(), outcome.truth) << to_line(GetParam(), outcome);
}

INSTANTIATE_TEST_SUITE_P(Sample, BlindEffect, testing::Values("stribeck", "hose_force", "payload", "current_lag"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST(BlindStudy, FindsNothingMissingOnACleanLogWithCorrelatedNoise) {
  const Outcome outcome = run_case("clean", 2, kNullRuns);  // correlation 0.98
  EXPECT_EQ(outcome.verdict, "nothing-missing") << to_line("clean-2", outcome);
}

TEST(BlindStudy, LooksBeyondTheBandOfNoisyEncodersWhereReversalsTakeTheRows) {
  // 5e-5 rad; up to 5 Hz next to nothing is left beside reversals
  const Outcome outcome = run_case("clean", 152, kNullRuns);
  EXPECT_EQ(outcome.verdict, "nothing-missing") << to_line("clean-152", outcome);
}

TEST(BlindStudy, GivesNoNameToWhatTheCatalogueLacks) {
  const Outcome outcome = run_case("outside", 1, kNullRuns);  // friction that varies over another joint
  EXPECT_EQ(outcome.verdict, "unknown-structure") << to_line("outside-1", outcome);
}

TEST(BlindStudy, NamesBothOfTwoEffectsInOneDrive) {
  const Outcome outcome = run_case("pairs", 51, kNullRuns);  // friction that varies over the turn, and that bends over
  auto named = split(outcome.named), truth = split(outcome.truth);
  std::sort(named.begin(), named.end());
  std::sort(truth.begin(), truth.end());
  EXPECT_EQ(named, truth) << to_line("pairs-51", outcome);
}

TEST(DrawnStudy, MakesTheSameLogsOfTheSameCase) {
  const std::vector<Log> one = record_drawn(make_drawn_case("dirty-effects", 2)),
                         again = record_drawn(make_drawn_case("dirty-effects", 2));  // an axis
  ASSERT_EQ(one.size(), 3u);
  ASSERT_EQ(again.size(), 3u);
  for (std::size_t l = 0; l < 3; ++l) {
    EXPECT_EQ(one[l].q, again[l].q);
    EXPECT_EQ(one[l].tau, again[l].tau);
  }
}

TEST(DrawnStudy, FindsNothingMissingOnACleanAxis) {
  const Outcome outcome = run_case("any-clean", 2, kNullRuns);
  EXPECT_EQ(outcome.verdict, "nothing-missing") << to_line("any-clean-2", outcome);
}

TEST(DrawnStudy, ReadsLinesOfTheFixedRobotsAndRefusesOthers) {
  const std::string path = testing::TempDir() + "blind_lines.csv";
  std::ofstream(path) << "effects-3,payload@platform,1,rho 0,named,payload@platform,,1,1,2,0.1,0.1,0.01\n";
  const Outcomes old = read_outcomes(path);
  ASSERT_EQ(old.size(), 1u);
  EXPECT_EQ(old[0].second.type, "delta3");
  EXPECT_FALSE(old[0].second.dirty);
  std::ofstream(path, std::ios::app) << "effects-4,payload@platform,1,rho 0\n";
  EXPECT_THROW((void)read_outcomes(path), Error);
}

}  // namespace
}  // namespace deltadyn::blind
