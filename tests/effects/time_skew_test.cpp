#include "deltadyn/effects/time_skew.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(TimeSkew, ShiftsASmoothTorqueBothWays) {
  Eigen::VectorXd torque(400);
  const auto tau = [](double k) { return std::sin(0.05 * k); };
  for (Eigen::Index k = 0; k < 400; ++k) torque(k) = tau(static_cast<double>(k));
  for (const double delay : {-2.4e-3, 1.7e-3}) {
    const Eigen::VectorXd late = effects::TimeSkew::record(torque, 1e-3, delay, {});
    for (Eigen::Index k = 10; k < 390; ++k) EXPECT_NEAR(late(k), tau(static_cast<double>(k) - 1e3 * delay), 1e-6);
  }
}

}  // namespace
}  // namespace deltadyn
