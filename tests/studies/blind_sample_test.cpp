// A seeded sample of the blind study; the whole of it runs by blind_study.

#include <algorithm>
#include <gtest/gtest.h>

#include "studies/blind_case.hpp"

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

}  // namespace
}  // namespace deltadyn::blind
