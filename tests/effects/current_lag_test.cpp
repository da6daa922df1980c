#include "deltadyn/effects/current_lag.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(CurrentLag, ReachesMostOfAStepAfterItsTime) {
  Eigen::VectorXd torque = Eigen::VectorXd::Ones(301);
  torque(0) = 0;
  EXPECT_NEAR(effects::CurrentLag::record(torque, 1e-5, 0.003, {0.003, 0})(300), 1 - std::exp(-1.0), 2e-3);
}

TEST(CurrentLag, TrailsARampByItsTimeAndACommandLeadsIt) {
  const Eigen::VectorXd ramp = Eigen::VectorXd::LinSpaced(200, 0, 199e-3);
  EXPECT_NEAR(effects::CurrentLag::record(ramp, 1e-3, 0.004, {0.004, 0})(199), ramp(199) - 0.004, 1e-12);
  EXPECT_LT(
      (effects::CurrentLag::record(ramp, 1e-3, 0.004, {0.004, 1}) - ramp.array().operator+(0.004).matrix()).norm(),
      1e-12);
  EXPECT_EQ(effects::CurrentLag::record(ramp, 1e-3, 0.0, {0, 0}), ramp);
}

}  // namespace
}  // namespace deltadyn
