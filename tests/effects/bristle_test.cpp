#include "deltadyn/effects/bristle.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(Bristle, BuildsUpOverItsDisplacementWhateverTheStep) {
  Bristle<double> coarse(0.01, -1.0), fine(0.01, -1.0);
  coarse.move(0.02);
  for (int k = 0; k < 1000; ++k) fine.move(2e-5);
  EXPECT_NEAR(coarse.state(), 1 - 2 * std::exp(-2.0), 1e-12);
  EXPECT_NEAR(fine.state(), coarse.state(), 1e-9);
  EXPECT_EQ(bristle_rate(3.0, 1.0, 0.01), 0.0);
}

TEST(Bristle, DampingIsAheadOfTheStateUntilItHasBuiltUp) {
  constexpr double kRate = 0.5, kDisplacement = 0.01, kDamping_s = 2e-3, kStep = 1e-7;
  Bristle<double> now(kDisplacement, -1.0), later(kDisplacement, -1.0);
  now.move(0.003);
  later.move(0.003 + kRate * kStep);
  const double rate = (later.state() - now.state()) / kStep;
  EXPECT_NEAR(damped_bristle(kRate, now.state(), kDisplacement, kDamping_s), now.state() + kDamping_s * rate, 1e-5);
  EXPECT_EQ(damped_bristle(kRate, 1.0, kDisplacement, kDamping_s), 1.0);
  EXPECT_EQ(damped_bristle(0.0, 0.3, kDisplacement, kDamping_s), 0.3);
}

}  // namespace
}  // namespace deltadyn
