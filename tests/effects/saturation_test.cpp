#include "deltadyn/effects/saturation.hpp"

#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(Saturation, LeavesSmallTorquesAlone) {
  const Eigen::VectorXd torque = Eigen::Vector3d(4, 7, -7);
  EXPECT_EQ(effects::Saturation::record(torque, 1e-3, 1.0, {5}), Eigen::VectorXd(Eigen::Vector3d(4, 5, -5)));
  EXPECT_EQ(effects::Saturation::record(torque, 1e-3, 0.5, {5}), Eigen::VectorXd(Eigen::Vector3d(4, 6, -6)));
}

}  // namespace
}  // namespace deltadyn
