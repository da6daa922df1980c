#include "deltadyn/effects/base_tilt.hpp"

#include <gtest/gtest.h>

#include "deltadyn/runtime/changed_machine.hpp"

namespace deltadyn {
namespace {

TEST(BaseTilt, TurnsGravityAndKeepsItsSizeToFirstOrder) {
  ChangedMachine machine{RobotDescription()};
  machine.description.gravity << 0, 0, -9.81;
  effects::BaseTilt::change(machine, -1, {0.01}, {});
  EXPECT_NEAR(machine.description.gravity.y(), 0.0981, 1e-12);
  EXPECT_NEAR(machine.description.gravity.norm(), 9.81, 1e-3);
}

}  // namespace
}  // namespace deltadyn
