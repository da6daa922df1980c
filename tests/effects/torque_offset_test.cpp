#include "deltadyn/effects/torque_offset.hpp"

#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(TorqueOffset, IsTheParameterItself) {
  EXPECT_EQ(torque_offset<double>(), 1.0);
  EXPECT_EQ(torque_offset<float>(), 1.0F);
}

}  // namespace
}  // namespace deltadyn
