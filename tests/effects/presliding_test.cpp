#include "deltadyn/effects/presliding.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(Presliding, BuildsUpOverItsDisplacementWhateverTheStep) {
  Presliding<double> coarse(0.01, -1.0), fine(0.01, -1.0);
  coarse.move(0.02);
  for (int k = 0; k < 1000; ++k) fine.move(2e-5);
  EXPECT_NEAR(coarse.state(), 1 - 2 * std::exp(-2.0), 1e-12);
  EXPECT_NEAR(fine.state(), coarse.state(), 1e-9);
  EXPECT_EQ(presliding_rate(3.0, 1.0, 0.01), 0.0);
}

}  // namespace
}  // namespace deltadyn
