#include "deltadyn/report/diagnosis_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

namespace deltadyn {
namespace {

using ::testing::HasSubstr;

Diagnosis with_gap(double share, double low, double high) {
  Diagnosis diagnosis;
  diagnosis.gap_shrink = share;
  diagnosis.gap_low = low;
  diagnosis.gap_high = high;
  return diagnosis;
}

TEST(GapText, GivesTheShareWithItsInterval) {
  EXPECT_THAT(gap_text(with_gap(0.952, 0.93, 0.971)), HasSubstr("95.2 % of the gap"));
  EXPECT_THAT(gap_text(with_gap(0.952, 0.93, 0.971)), HasSubstr("93.0 to 97.1 %"));
}

TEST(GapText, AnIntervalThatHoldsEverythingSaysNothing) {
  const Diagnosis diagnosis = with_gap(0.304, -0.38, 2.98);
  EXPECT_FALSE(shows_gap(diagnosis));
  EXPECT_THAT(gap_text(diagnosis), HasSubstr("too small to say"));
}

TEST(GapText, IsEmptyWithoutAGap) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(gap_text(with_gap(none, none, none)), "");
  EXPECT_FALSE(shows_gap(with_gap(none, none, none)));
}

}  // namespace
}  // namespace deltadyn
