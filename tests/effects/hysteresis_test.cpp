#include "deltadyn/effects/hysteresis.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

using effects::Hysteresis;

TEST(Hysteresis, ClosesALoopWithinItsBounds) {
  const Shape<double> shape{0.1, 2, 0};
  const auto move = [&shape](double z, double way) { return Hysteresis::moved(z, way, JointInput<double>(), shape); };
  double z = 0, area = 0;
  for (int k = 0; k < 400; ++k) z = move(z, 0.005);
  const double up = z;
  for (int k = 0; k < 400; ++k) {
    z = move(z, -0.005);
    area += 0.005 * (up - z);
  }
  EXPECT_NEAR(up, 1.0, 1e-6);
  EXPECT_NEAR(z, -1.0, 1e-6);
  EXPECT_GT(area, 0.0);
}

TEST(Hysteresis, FollowsItsDifferentialEquationForEveryExponent) {
  for (const double n : {1.0, 1.5, 2.0, 3.0}) {
    const Shape<double> shape{0.1, n, 0};
    // Euler in small steps, there and back.
    double z = 0.4, exact = 0.4;
    constexpr double kStep = 1e-6;
    for (const double way : {-0.15, 0.12}) {
      const double step = way > 0 ? kStep : -kStep;
      for (int k = 0; k < std::lround(std::abs(way) / kStep); ++k) {
        const double size = std::pow(std::abs(z), n - 1) * z;
        z += (step - 0.5 * (std::abs(step) * size + step * std::pow(std::abs(z), n))) / shape[0];
      }
      exact = Hysteresis::moved(exact, way, JointInput<double>(), shape);
      EXPECT_NEAR(exact, z, 1e-5) << n;
    }
  }
}

TEST(Hysteresis, TwoStepsTheSameWayAreAsGoodAsTheirSum) {
  for (const double n : {1.0, 1.7, 2.0}) {
    const Shape<double> shape{0.2, n, 0};
    const auto move = [&shape](double z, double way) { return Hysteresis::moved(z, way, JointInput<double>(), shape); };
    EXPECT_NEAR(move(move(-0.6, 0.05), 0.3), move(-0.6, 0.35), 1e-7) << n;
  }
}

}  // namespace
}  // namespace deltadyn
