#include "deltadyn/runtime/random.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace deltadyn {
namespace {

// Reference numbers: drawn once with the distributions of the GNU library, version 12.

TEST(Random, NormalNumbersAreTheSameEverywhere) {
  std::mt19937_64 wide(42);
  NormalDistribution normal;
  for (const double value : {0.70498826642085988, 1.2938204232729367, -0.5740948067202617, 0.39797739618378897})
    EXPECT_DOUBLE_EQ(normal(wide), value);
  std::mt19937 narrow(42);
  NormalDistribution other(1, 0.5);
  for (const double value : {0.72488275278975323, 1.2577165348456005, 1.2369304278331112, 1.6842250611080374})
    EXPECT_DOUBLE_EQ(other(narrow), value);
}

TEST(Random, UniformNumbersAreTheSameEverywhere) {
  std::mt19937_64 wide(42);
  const UniformDistribution uniform(-1, 3);
  for (const double value : {2.0206221318181559, 1.5561255754187897, 2.0085808029921064, -0.45490926547025157})
    EXPECT_DOUBLE_EQ(uniform(wide), value);
  std::mt19937 narrow(42);
  for (const double value : {2.1861719371513839, -0.26626084842652609, 2.118763990450645, 1.3874006463202262})
    EXPECT_DOUBLE_EQ(uniform(narrow), value);
}

TEST(Random, WholeNumbersAreTheSameEverywhere) {
  std::mt19937_64 random(42);
  const UniformIndex pick(10);
  for (const std::size_t value : {7U, 6U, 7U, 1U, 9U, 0U, 5U, 3U}) EXPECT_EQ(pick(random), value);
}

TEST(Random, NormalNumbersHaveTheMomentsOfTheirDistribution) {
  constexpr int kCount = 200000;
  std::mt19937_64 random(1);
  NormalDistribution normal(3, 2);
  double sum = 0, square = 0, fourth = 0;
  for (int k = 0; k < kCount; ++k) {
    const double x = (normal(random) - 3) / 2;
    sum += x;
    square += x * x;
    fourth += x * x * x * x;
  }
  EXPECT_NEAR(sum / kCount, 0, 0.01);
  EXPECT_NEAR(square / kCount, 1, 0.02);
  EXPECT_NEAR(fourth / kCount, 3, 0.1);
}

TEST(Random, WholeNumbersComeEquallyOften) {
  constexpr std::size_t kCount = 7, kDraws = 70000;
  std::mt19937_64 random(1);
  const UniformIndex pick(kCount);
  std::vector<int> often(kCount, 0);
  for (std::size_t k = 0; k < kDraws; ++k) ++often[pick(random)];
  for (const int count : often) EXPECT_NEAR(count, 10000, 400);
}

/// A generator that gives its largest number always.
struct Largest {
  using result_type = std::uint64_t;
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return ~result_type{0}; }
  result_type operator()() { return max(); }
};

TEST(Random, UniformNumbersStayBelowTheirUpperEnd) {
  Largest largest;
  EXPECT_LT(canonical(largest), 1);
  EXPECT_LT(unit_of_53_bits(largest), 1);
  EXPECT_EQ(UniformIndex(5)(largest), 4U);
}

#ifdef __GLIBCXX__
template <class Generator>
void compare_with_the_library(Generator generator) {
  Generator ours = generator, theirs = generator;
  NormalDistribution normal(0.3, 1.7);
  std::normal_distribution<double> their_normal(0.3, 1.7);
  for (int k = 0; k < 10000; ++k) ASSERT_EQ(normal(ours), their_normal(theirs));
  const UniformDistribution uniform(-2, 5);
  std::uniform_real_distribution<double> their_uniform(-2, 5);
  for (int k = 0; k < 10000; ++k) ASSERT_EQ(uniform(ours), their_uniform(theirs));
}

TEST(Random, IsTheGnuLibraryToTheBit) {
  compare_with_the_library(std::mt19937_64(7));
  compare_with_the_library(std::mt19937(7));
  std::mt19937_64 ours(7), theirs(7);
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{1000}, std::size_t{3} << 62U}) {
    std::uniform_int_distribution<std::size_t> their_pick(0, count - 1);
    const UniformIndex pick(count);
    for (int k = 0; k < 1000; ++k) ASSERT_EQ(pick(ours), their_pick(theirs));
  }
}
#endif

}  // namespace
}  // namespace deltadyn
