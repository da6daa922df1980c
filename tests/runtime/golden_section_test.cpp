#include "deltadyn/runtime/golden_section.hpp"

#include <gtest/gtest.h>
#include <vector>

namespace deltadyn {
namespace {

TEST(GoldenSection, FindsTheLeastValueToTheWidthThatIsLeft) {
  for (const double truth : {-0.9, 0.0, 0.123, 2.5}) {
    const auto f = [&](double x) { return std::abs(x - truth); };
    const double width = 4 * std::pow(kGoldenShare, 30);
    EXPECT_NEAR(golden_section(f, -1, 3, 30), truth, 0.5 * width * 1.001);
  }
}

TEST(GoldenSection, EvaluatesOnceAStepAndInside) {
  std::vector<double> at;
  (void)golden_section(
      [&](double x) {
        at.push_back(x);
        return x * x;
      },
      -1, 3, 9);
  EXPECT_EQ(at.size(), 11U);
  for (const double x : at) {
    EXPECT_GT(x, -1);
    EXPECT_LT(x, 3);
  }
}

TEST(GoldenSection, ALeastValueAtAnEndIsApproached) {
  EXPECT_NEAR(golden_section([](double x) { return x; }, 2, 3, 40), 2, 1e-8);
  EXPECT_NEAR(golden_section([](double x) { return -x; }, 2, 3, 40), 3, 1e-8);
}

TEST(GoldenSection, AnEmptyIntervalIsItsOwnAnswer) {
  EXPECT_EQ(golden_section([](double x) { return x; }, 2, 2, 5), 2);
}

TEST(GoldenSectionInLogarithm, StopsAtTheRatioOfTheEnds) {
  const auto f = [](double x) { return std::pow(std::log(x / 3e-4), 2); };
  EXPECT_NEAR(golden_section_in_logarithm(f, 1e-6, 1e-1), 3e-4, 0.006 * 3e-4);
  EXPECT_NEAR(golden_section_in_logarithm(f, 1e-6, 1e-1, 1.000001), 3e-4, 1e-6 * 3e-4);
}

}  // namespace
}  // namespace deltadyn
