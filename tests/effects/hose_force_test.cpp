#include "deltadyn/effects/hose_force.hpp"

#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(HoseForce, IsAForceAtTheOriginAndASpringAlongEachAxis) {
  PlateInput<double> in;
  in.position << 0.1, -0.2, -0.7;
  const auto columns = effects::HoseForce::columns(in, {});
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(columns[static_cast<std::size_t>(axis)], Eigen::Vector3d::Unit(axis));
    EXPECT_EQ(columns[static_cast<std::size_t>(3 + axis)], in.position(axis) * Eigen::Vector3d::Unit(axis));
  }
}

}  // namespace
}  // namespace deltadyn
