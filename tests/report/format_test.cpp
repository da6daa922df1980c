#include "deltadyn/report/format.hpp"

#include <gtest/gtest.h>
#include <limits>

namespace deltadyn {
namespace {

const double kNaN = std::numeric_limits<double>::quiet_NaN();
const double kInfinity = std::numeric_limits<double>::infinity();

TEST(FormatNumber, SignificantDigits) {
  EXPECT_EQ(format_number(0.0), "0");
  EXPECT_EQ(format_number(-0.0), "0");
  EXPECT_EQ(format_number(1.0), "1.000");
  EXPECT_EQ(format_number(95.114), "95.11");
  EXPECT_EQ(format_number(-0.012346), "-0.01235");
  EXPECT_EQ(format_number(9.9996), "10.00");
  EXPECT_EQ(format_number(12345.0), "12350");
  EXPECT_EQ(format_number(12345.0, 2), "12000");
  EXPECT_EQ(format_number(0.00012, 2), "0.00012");
  EXPECT_EQ(format_number(7.6, 0), "8");
}

TEST(FormatNumber, PowersOfTenFarFromOne) {
  EXPECT_EQ(format_number(0.000012345, 3), "1.23 × 10⁻⁵");
  EXPECT_EQ(format_number(-6.02214e23, 3), "-6.02 × 10²³");
  EXPECT_EQ(format_number(999999.9, 3), "1.00 × 10⁶");
  EXPECT_EQ(format_number(3e-310, 2), "3.0 × 10⁻³¹⁰");
}

TEST(FormatNumber, NotFinite) {
  EXPECT_EQ(format_number(kNaN), "–");
  EXPECT_EQ(format_number(kInfinity), "∞");
  EXPECT_EQ(format_number(-kInfinity), "-∞");
}

TEST(FormatNumber, WithUnit) {
  EXPECT_EQ(format_number(12.3456, "Nm"), "12.35 N m");
  EXPECT_EQ(format_number(0.5, "1", 2), "0.50");
}

struct UncertaintyCase {
  double value, uncertainty;
  const char* text;
};
class FormatWithUncertainty : public ::testing::TestWithParam<UncertaintyCase> {};

TEST_P(FormatWithUncertainty, EndsAtTheUncertaintysSecondDigit) {
  EXPECT_EQ(format_with_uncertainty(GetParam().value, GetParam().uncertainty), GetParam().text);
}

INSTANTIATE_TEST_SUITE_P(
    Cases, FormatWithUncertainty,
    ::testing::Values(UncertaintyCase{1.23449, 0.0123, "1.234 ± 0.012"},
                      UncertaintyCase{-1.23449, 0.0123, "-1.234 ± 0.012"}, UncertaintyCase{1.0, 0.0996, "1.00 ± 0.10"},
                      UncertaintyCase{95.114, 1.34, "95.1 ± 1.3"}, UncertaintyCase{203.4, 12.0, "203 ± 12"},
                      UncertaintyCase{1234.5, 120.0, "1230 ± 120"}, UncertaintyCase{0.0004, 1.2, "0.0 ± 1.2"},
                      UncertaintyCase{-0.0004, 1.2, "0.0 ± 1.2"}, UncertaintyCase{0.0, 0.0123, "0.000 ± 0.012"},
                      UncertaintyCase{1.2345e-5, 1.2e-7, "(1.234 ± 0.012) × 10⁻⁵"},
                      UncertaintyCase{1.2e-9, 3.4e-5, "(0.0 ± 3.4) × 10⁻⁵"},
                      UncertaintyCase{2.5e7, 1.5e5, "(2.500 ± 0.015) × 10⁷"}, UncertaintyCase{1.25, 0.0, "1.25"},
                      UncertaintyCase{1.23456, kNaN, "1.235"}, UncertaintyCase{1.23456, -1.0, "1.235"},
                      UncertaintyCase{1.23456, kInfinity, "1.235 ± ∞"}, UncertaintyCase{kNaN, 0.1, "–"}));

TEST(FormatUncertainty, WithUnit) {
  EXPECT_EQ(format_with_uncertainty(0.0132, 0.00012, "kg m^2"), "0.01320 ± 0.00012 kg m²");
  EXPECT_EQ(format_with_uncertainty(1.2e-5, 1e-6, "kg_m2"), "(1.20 ± 0.10) × 10⁻⁵ kg m²");
}

TEST(FormatEstimate, ShowsAValueThatItsIntervalDwarfs) {
  EXPECT_EQ(format_estimate(0.2, 30, "kg"), "0.20 ± 30 kg");
  EXPECT_EQ(format_estimate(-1.9e-5, 0.0012), "-1.9 × 10⁻⁵ ± 0.0012");
  EXPECT_EQ(format_estimate(0, 1.2), "0.0 ± 1.2");
  EXPECT_EQ(format_estimate(1.23449, 0.0123), "1.234 ± 0.012");
}

TEST(FormatInterval, DigitsFollowItsLength) {
  EXPECT_EQ(format_interval(1.2112, 1.2634, "kg"), "1.2112 … 1.2634 kg");
  EXPECT_EQ(format_interval(-3.0, 4.0), "-3.00 … 4.00");
  EXPECT_EQ(format_interval(1e-6, 3e-6, "kg"), "(1.00 … 3.00) × 10⁻⁶ kg");
  EXPECT_EQ(format_interval(2.0, 2.0), "2.000 … 2.000");
  EXPECT_EQ(format_interval(-kInfinity, 2.0), "-∞ … 2.000");
}

TEST(FormatPercent, TakesAFraction) {
  EXPECT_EQ(format_percent(0.012345), "1.23 %");
  EXPECT_EQ(format_percent(0.5, 2), "50 %");
  EXPECT_EQ(format_percent(kNaN), "– %");
}

TEST(FormatCount, GroupsOfThree) {
  EXPECT_EQ(format_count(0), "0");
  EXPECT_EQ(format_count(999), "999");
  EXPECT_EQ(format_count(1000), "1\u202F000");
  EXPECT_EQ(format_count(-1234567), "-1\u202F234\u202F567");
}

TEST(FormatDuration, UnitSuitsTheLength) {
  EXPECT_EQ(format_duration(0.0000321), "32.1 µs");
  EXPECT_EQ(format_duration(0.0283), "28.3 ms");
  EXPECT_EQ(format_duration(12.5), "12.5 s");
  EXPECT_EQ(format_duration(125.0), "2 min 5 s");
  EXPECT_EQ(format_duration(3725.0), "1 h 2 min");
  EXPECT_EQ(format_duration(-0.5), "-500 ms");
}

TEST(PrettyUnit, KnowsTheUnitsOfOurFiles) {
  EXPECT_EQ(pretty_unit("Nm"), "N m");
  EXPECT_EQ(pretty_unit("rad_s2"), "rad/s²");
  EXPECT_EQ(pretty_unit("kg m^2"), "kg m²");
  EXPECT_EQ(pretty_unit("N*m*s/rad"), "N m s/rad");
  EXPECT_EQ(pretty_unit("s^-1"), "s⁻¹");
  EXPECT_EQ(pretty_unit("m^"), "m^");
  EXPECT_EQ(pretty_unit("furlong"), "furlong");
}

}  // namespace
}  // namespace deltadyn
