#include "deltadyn/signal/time_grid.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "deltadyn/runtime/random.hpp"

#include "signal/multi_sine.hpp"

namespace deltadyn {
namespace {

TEST(TimeGrid, FindsTheStepBehindRoundedAndJitteredStamps) {
  std::mt19937_64 random(11);
  for (const double jitter : {0.0, 0.1, 0.3, 0.44}) {
    UniformDistribution noise(-jitter, jitter);
    Eigen::VectorXd t = testing_support::times(8000, 5000);
    for (double& stamp : t) stamp += noise(random) / 8000;
    const TimeGrid grid = fit_time_grid(t);
    EXPECT_NEAR(grid.step_s * 8000, 1.0, 1e-4) << jitter;
    EXPECT_EQ(grid.index.back(), 4999) << jitter;
    EXPECT_LE(grid.jitter, jitter + 0.03);
  }
}

TEST(TimeGrid, FindsGapsOfAnyLength) {
  for (const Eigen::Index missing : {1, 2, 50}) {
    for (const Eigen::Index at : {1, 500, 998}) {
      Eigen::VectorXd t = testing_support::times(1000, 1000);
      t.tail(1000 - at).array() += 0.001 * static_cast<double>(missing);
      const TimeGrid grid = fit_time_grid(t);
      EXPECT_EQ(grid.index.back(), 999 + missing);
      EXPECT_EQ(grid.index[static_cast<std::size_t>(at)], at + missing);
      EXPECT_LT(grid.jitter, 1e-6);
    }
  }
}

}  // namespace
}  // namespace deltadyn
