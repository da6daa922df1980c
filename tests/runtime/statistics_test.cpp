#include "deltadyn/runtime/statistics.hpp"

#include <gtest/gtest.h>
#include <vector>

namespace deltadyn {
namespace {

std::vector<double> shuffled_to(int count) {
  std::vector<double> values;
  for (int k = 0; k < count; ++k)
    values.push_back(static_cast<double>((7 * k) % count));  // 0 .. count - 1 if 7 does not divide it
  return values;
}

TEST(Statistics, OrderStatisticIsTheValueAtItsPlace) {
  for (std::size_t rank = 0; rank < 11; ++rank)
    EXPECT_EQ(order_statistic(shuffled_to(11), rank), static_cast<double>(rank));
}

TEST(Statistics, QuantileIsTheValueAtTheFloorOfItsPlace) {
  EXPECT_EQ(quantile(shuffled_to(11), 0.0), 0.0);
  EXPECT_EQ(quantile(shuffled_to(11), 0.29), 2.0);
  EXPECT_EQ(quantile(shuffled_to(11), 0.3), 3.0);
  EXPECT_EQ(quantile(shuffled_to(11), 1.0), 10.0);
  EXPECT_EQ(quantile(std::vector<double>{}, 0.5), 0.0);
}

TEST(Statistics, TheTwoMediansDifferForAnEvenNumberOfValues) {
  EXPECT_EQ(lower_median(shuffled_to(11)), 5.0);
  EXPECT_EQ(upper_median(shuffled_to(11)), 5.0);
  EXPECT_EQ(lower_median(shuffled_to(10)), 4.0);
  EXPECT_EQ(upper_median(shuffled_to(10)), 5.0);
  EXPECT_EQ(lower_median(std::vector<double>{3.0}), 3.0);
  EXPECT_EQ(upper_median(std::vector<double>{3.0}), 3.0);
  EXPECT_EQ(lower_median(std::vector<double>{}), 0.0);
  EXPECT_EQ(upper_median(std::vector<double>{}), 0.0);
  EXPECT_EQ(upper_median(std::vector<int>{2, 1}), 2);
}

TEST(Statistics, StdOfSizesIsThatOfNormalNoiseAndIgnoresTheLargestHundredth) {
  // Sizes at even steps of the normal distribution: erf(x / sqrt 2) = (k + 0.5) / n, by bisection.
  constexpr int kCount = 1000;
  std::vector<double> sizes;
  for (int k = 0; k < kCount; ++k) {
    double low = 0, high = 10;
    for (int i = 0; i < 60; ++i) {
      const double x = 0.5 * (low + high);
      (std::erf(x / std::sqrt(2.0)) < (k + 0.5) / kCount ? low : high) = x;
    }
    sizes.push_back(2.5 * low);
  }
  EXPECT_NEAR(std_of_sizes(sizes), 2.5, 0.005);
  for (int k = kCount - 10; k < kCount; ++k) sizes[static_cast<std::size_t>(k)] = 1e6;
  EXPECT_NEAR(std_of_sizes(sizes), 2.5, 0.005);
  EXPECT_EQ(std_of_sizes({}), 0.0);
}

TEST(Statistics, RootMeanSquare) {
  EXPECT_DOUBLE_EQ(root_mean_square(Eigen::Vector2d(1, 7)), 5.0);
  EXPECT_DOUBLE_EQ(root_mean_square(50.0, 2.0), 5.0);
  EXPECT_EQ(root_mean_square(Eigen::VectorXd(0)), 0.0);
  EXPECT_EQ(root_mean_square(1.0, 0.0), 0.0);
}

TEST(Statistics, RootMeanSquareOfTheValuesThatCount) {
  Eigen::Array<bool, Eigen::Dynamic, 1> counts(3);
  counts << true, false, true;
  EXPECT_DOUBLE_EQ(root_mean_square(Eigen::Vector3d(1, 100, 7), counts), 5.0);
  counts.setConstant(false);
  EXPECT_EQ(root_mean_square(Eigen::Vector3d(1, 100, 7), counts), 0.0);
}

}  // namespace
}  // namespace deltadyn
