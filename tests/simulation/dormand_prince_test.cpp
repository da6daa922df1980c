#include "deltadyn/simulation/dormand_prince.hpp"

#include <Eigen/Core>
#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

using State = Eigen::Vector2d;

bool swing(double t, const State& x, State& rate) {
  rate << x(1), -x(0) + std::cos(2 * t);
  return true;
}
State exact(double t) {
  return {(4 * std::cos(t) - std::cos(2 * t)) / 3, (-4 * std::sin(t) + 2 * std::sin(2 * t)) / 3};
}

double error_after(int steps, double* estimate = nullptr) {
  State x = exact(0), rate, next, rate_next, error;
  const double h = 2.0 / steps;
  (void)swing(0, x, rate);
  for (int k = 0; k < steps; ++k) {
    EXPECT_TRUE(dormand_prince_step(swing, k * h, h, x, rate, next, rate_next, error));
    if (estimate != nullptr && k == 0) *estimate = error.norm();
    x = next;
    rate = rate_next;
  }
  return (x - exact(2)).norm();
}

TEST(DormandPrince, IsOfFifthOrder) {
  const double order = std::log2(error_after(20) / error_after(40));
  EXPECT_GT(order, 4.7);
  EXPECT_LT(order, 5.5);
}

TEST(DormandPrince, EstimatesItsErrorToFifthOrderOfTheStep) {
  double coarse = 0, fine = 0;
  (void)error_after(20, &coarse);
  (void)error_after(40, &fine);
  EXPECT_NEAR(std::log2(coarse / fine), 5, 0.5);
}

TEST(DormandPrince, StopsWhereTheSystemCannotBeEvaluated) {
  const State x = exact(0);
  State rate = State::Zero(), next, rate_next, error;
  const auto wall = [](double t, const State&, State& r) {
    r.setZero();
    return t < 0.5;
  };
  EXPECT_TRUE(dormand_prince_step(wall, 0.0, 0.4, x, rate, next, rate_next, error));
  EXPECT_FALSE(dormand_prince_step(wall, 0.0, 0.6, x, rate, next, rate_next, error));
}

}  // namespace
}  // namespace deltadyn
