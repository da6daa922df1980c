#include "deltadyn/report/thinning.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "deltadyn/runtime/random.hpp"

namespace deltadyn {
namespace {

constexpr Eigen::Index kMany = 500'000;
const double kGap = std::numeric_limits<double>::quiet_NaN();

Series noise(SeriesStyle style = SeriesStyle::line) {
  std::mt19937 generator(7);
  NormalDistribution normal(0.0, 0.1);
  Series series{"noise", Eigen::VectorXd::LinSpaced(kMany, 0.0, 1.0), Eigen::VectorXd(kMany), style};
  for (double& y : series.y) y = normal(generator);
  return series;
}

PlotFrame frame() {
  return {{0.0, 1.0}, {-5.0, 5.0}};
}

TEST(Thin, KeepsEveryColumnsExtremesOfALine) {
  const Series full = noise();
  const Series few = thin(full, frame());
  EXPECT_LE(few.x.size(), 2 * 802);
  Eigen::MatrixXd full_ends = Eigen::MatrixXd::Constant(801, 2, kGap), few_ends = full_ends;
  const auto collect = [](const Series& series, Eigen::MatrixXd& ends) {
    for (Eigen::Index i = 0; i < series.x.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(std::floor(series.x(i) * 800.0));
      ends(column, 0) = std::fmin(ends(column, 0), series.y(i));
      ends(column, 1) = std::fmax(ends(column, 1), series.y(i));
    }
  };
  collect(full, full_ends);
  collect(few, few_ends);
  EXPECT_EQ(full_ends, few_ends);
}

TEST(Thin, KeepsASinglePeakInEveryStyle) {
  for (const SeriesStyle style :
       {SeriesStyle::line, SeriesStyle::points, SeriesStyle::impulses, SeriesStyle::steps, SeriesStyle::errorbars}) {
    Series series = noise(style);
    series.y(123'457) = 4.5;
    series.y(345'679) = -4.5;
    if (style == SeriesStyle::errorbars) series.y_error = Eigen::VectorXd::Constant(kMany, 0.01);
    const Series few = thin(series, frame());
    EXPECT_LT(few.x.size(), 5'000);
    EXPECT_EQ(few.y.maxCoeff(), 4.5);
    EXPECT_EQ(few.y.minCoeff(), -4.5);
    EXPECT_EQ(few.y_error.size(), style == SeriesStyle::errorbars ? few.y.size() : 0);
  }
}

TEST(Thin, KeepsTheBarThatReachesFarthest) {
  Series series = noise(SeriesStyle::errorbars);
  series.y_error = Eigen::VectorXd::Constant(kMany, 0.01);
  series.y_error(200'001) = 4.0;
  EXPECT_EQ(thin(series, frame()).y_error.maxCoeff(), 4.0);
}

TEST(Thin, KeepsTheOrderOfALine) {
  const Series few = thin(noise(), frame());
  for (Eigen::Index i = 1; i < few.x.size(); ++i) ASSERT_LT(few.x(i - 1), few.x(i));
}

TEST(Thin, KeepsGaps) {
  Series series = noise();
  series.y.segment(100'000, 50'000).setConstant(kGap);
  const Series few = thin(series, frame());
  bool gap = false;
  for (Eigen::Index i = 1; i + 1 < few.x.size(); ++i) {
    if (!std::isnan(few.y(i))) continue;
    gap = true;
    EXPECT_LE(few.x(i - 1), 0.2);
    EXPECT_GE(few.x(i - 1), 0.19);
    EXPECT_GE(few.x(i + 1), 0.3);
    EXPECT_LE(few.x(i + 1), 0.31);
  }
  EXPECT_TRUE(gap);
}

TEST(Thin, ManyGapsStayFew) {
  Series series = noise();
  for (Eigen::Index i = 0; i < kMany; i += 2) series.y(i) = kGap;
  const Series few = thin(series, frame());
  EXPECT_LT(few.x.size(), 5 * 802);
  EXPECT_GT(few.y.array().isFinite().count(), 2 * 790);
}

TEST(Thin, ACurveThatRunsBackAndForthStaysWithinAPixelOrTwo) {
  Series series{"circle", Eigen::VectorXd(kMany), Eigen::VectorXd(kMany)};
  for (Eigen::Index i = 0; i < kMany; ++i) {
    series.x(i) = 0.5 + 0.5 * std::cos(1e-4 * static_cast<double>(i));
    series.y(i) = 4.0 * std::sin(1e-4 * static_cast<double>(i));
  }
  const Series few = thin(series, frame());
  EXPECT_LE(few.x.size(), 6'000);
  EXPECT_GT(few.x.size(), 500);
  EXPECT_NEAR(few.y.maxCoeff(), 4.0, 10.0 / 240.0);
  EXPECT_NEAR(few.x.minCoeff(), 0.0, 1.0 / 800.0);
}

TEST(Thin, AShortSeriesComesBackUnchanged) {
  const Series series{"short", Eigen::VectorXd::LinSpaced(100, 0.0, 1.0), Eigen::VectorXd::LinSpaced(100, -1.0, 1.0)};
  const Series same = thin(series, frame());
  EXPECT_EQ(same.x, series.x);
  EXPECT_EQ(same.y, series.y);
}

TEST(Thin, OnLogAxesValuesThatAreNotPositiveBecomeGaps) {
  Series series{"log", Eigen::Vector3d(0.0, 1.0, 10.0), Eigen::Vector3d(1.0, -1.0, 2.0)};
  PlotFrame logarithmic{{1.0, 10.0}, {1.0, 10.0}, true, true};
  const Series result = thin(series, logarithmic);
  EXPECT_TRUE(std::isnan(result.y(0)));
  EXPECT_TRUE(std::isnan(result.y(1)));
  EXPECT_EQ(result.y(2), 2.0);
}

TEST(Thin, LogColumnsAreThoseOfThePicture) {
  Series series{"log", Eigen::VectorXd::LinSpaced(kMany, 1.0, 1e6), Eigen::VectorXd::Constant(kMany, 1.0)};
  series.y(3) = 4.0;
  const Series few = thin(series, {{1.0, 1e6}, {-5.0, 5.0}, true, false});
  EXPECT_EQ(few.x.head(5), series.x.head(5));  // far apart in the picture, although close in number
  EXPECT_EQ(few.y.maxCoeff(), 4.0);
}

TEST(Thin, AnEmptySeriesStaysEmpty) {
  EXPECT_EQ(thin(Series{"empty", {}, {}}, frame()).x.size(), 0);
}

}  // namespace
}  // namespace deltadyn
