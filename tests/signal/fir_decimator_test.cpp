#include "deltadyn/signal/fir_decimator.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/random.hpp"

#include "signal/multi_sine.hpp"

namespace deltadyn {
namespace {

using namespace deltadyn::testing_support;

TEST(FirDecimator, IsSymmetricFlatAndQuietWhereItShould) {
  for (const double cutoff : {4.0, 20.0, 45.0}) {
    const FirDecimator filter(1000, cutoff, 10);
    const Eigen::VectorXd& taps = filter.taps();
    EXPECT_EQ(taps.size(), 2 * filter.half_width() + 1);
    EXPECT_EQ(taps, Eigen::VectorXd(taps.reverse()));
    EXPECT_NEAR(taps.sum(), 1.0, 1e-14);
    EXPECT_NEAR(filter.gain(0), 1.0, 1e-14);
    EXPECT_NEAR(filter.gain(cutoff), 0.5, 1e-3);
    for (double f = 0; f <= 0.5 * cutoff; f += 0.05 * cutoff) EXPECT_NEAR(filter.gain(f), 1.0, 1e-3) << f;
    for (double f = 1.5 * cutoff; f < 500; f += 0.05 * cutoff) EXPECT_LT(std::abs(filter.gain(f)), 1e-3) << f;
  }
}

// Sums over long blocks of filtered white noise vary as much as the filter says.
TEST(FirDecimator, KnowsHowItCorrelatesWhiteNoise) {
  std::mt19937_64 random(3);
  NormalDistribution normal;
  for (const int factor : {4, 8, 16}) {
    const FirDecimator filter(1000, 25.0, factor);
    const Eigen::MatrixXd noise = Eigen::MatrixXd::NullaryExpr(400000, 1, [&]() { return normal(random); });
    Eigen::MatrixXd out(filter.outputs(noise.rows()), 1);
    filter.apply(noise, out);
    const Eigen::Index block = 400, blocks = out.rows() / block;
    double of_sums = 0;
    for (Eigen::Index b = 0; b < blocks; ++b) of_sums += std::pow(out.col(0).segment(b * block, block).sum(), 2);
    const double correlation =
        of_sums / static_cast<double>(blocks * block) / (out.squaredNorm() / static_cast<double>(out.rows()));
    const double chance = 3 * std::sqrt(2.0 / static_cast<double>(blocks));
    EXPECT_NEAR(correlation / filter.white_correlation(), 1.0, chance) << factor;
  }
  EXPECT_GT(FirDecimator(1000, 25.0, 4).white_correlation(), 3);
}

TEST(FirDecimator, HasNoLag) {
  const FirDecimator filter(1000, 20.0, 7);
  const Eigen::VectorXd t = times(1000, 3000);
  const Eigen::MatrixXd in = ((2 * std::numbers::pi * 5.0) * t.array()).sin().matrix();
  Eigen::MatrixXd out(filter.outputs(3000), 1);
  filter.apply(in, out);
  for (Eigen::Index k = 0; k < out.rows(); ++k) EXPECT_NEAR(out(k, 0), in(filter.centre(k), 0), 1e-3);
  Eigen::MatrixXd line = (3.0 - 2.0 * t.array()).matrix();
  filter.apply(line, out);
  for (Eigen::Index k = 0; k < out.rows(); ++k) EXPECT_NEAR(out(k, 0), line(filter.centre(k), 0), 1e-12);
}

TEST(FirDecimator, BlocksGiveTheSameAsTheWhole) {
  std::mt19937_64 random(3);
  NormalDistribution normal;
  const Eigen::MatrixXd in = Eigen::MatrixXd::NullaryExpr(5000, 3, [&] { return normal(random); });
  const FirDecimator filter(1000, 30.0, 9);
  const Eigen::Index n = filter.outputs(5000);
  EXPECT_LE(filter.centre(n - 1) + filter.half_width(), 4999);
  EXPECT_GT(filter.centre(n) + filter.half_width(), 4999);
  Eigen::MatrixXd whole(n, 3);
  filter.apply(in, whole);
  for (const Eigen::Index block : {1, 17, 100}) {
    for (Eigen::Index first = 0; first < n; first += block) {
      const Eigen::Index count = std::min(block, n - first);
      const Eigen::Index offset = filter.centre(first) - filter.half_width();
      Eigen::MatrixXd out(count, 3);
      filter.apply(in.middleRows(offset, filter.inputs(count)), out);
      ASSERT_EQ(out, whole.middleRows(first, count)) << "block " << block << " at " << first;
    }
  }
}

TEST(FirDecimator, RefusesAliasesAndBlocksThatAreTooShort) {
  EXPECT_THROW(FirDecimator(1000, 60.0, 10), Error);
  EXPECT_THROW(FirDecimator(1000, 0.0, 10), Error);
  EXPECT_THROW(FirDecimator(1000, 40.0, 0), Error);
  const FirDecimator filter(1000, 40.0, 10);
  EXPECT_EQ(filter.outputs(2 * filter.half_width()), 0);
  EXPECT_EQ(filter.outputs(2 * filter.half_width() + 1), 1);
  Eigen::MatrixXd out(2, 1);
  EXPECT_THROW(filter.apply(Eigen::MatrixXd::Zero(2 * filter.half_width() + 10, 1), out), Error);
}

}  // namespace
}  // namespace deltadyn
