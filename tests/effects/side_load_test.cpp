#include "deltadyn/effects/side_load.hpp"

#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(SideLoad, LeavesOutWhatActsAlongTheBar) {
  const Vector3<double> up(0, 0, 1), g(0, 0, -9.81);
  EXPECT_NEAR(side_load<double>(up, Vector3<double>(0, 0, 3), g), 0.0, 1e-12);
  EXPECT_NEAR(side_load<double>(up, Vector3<double>(4, 3, 0), g), 5.0, 1e-12);
}

}  // namespace
}  // namespace deltadyn
