#include "deltadyn/effects/kinematic_offset.hpp"

#include <gtest/gtest.h>

#include "deltadyn/runtime/changed_machine.hpp"

namespace deltadyn {
namespace {

ChangedMachine two_limbs(DriveKind kind) {
  RobotDescription robot;
  robot.drive_kind = kind;
  robot.limbs.resize(2);
  robot.limits.resize(2);
  for (auto& limb : robot.limbs) {
    limb.axis_L << 0, 0, 1;
    limb.p_DE_0 << 0.3, 0, 0;
    limb.strut = 0.8;
  }
  return ChangedMachine(robot);
}

TEST(KinematicOffset, ChangesHomeArmOrStrutOfItsLimbOnly) {
  ChangedMachine machine = two_limbs(DriveKind::revolute);
  effects::KinematicOffset::change(machine, 1, {0.01}, {0});
  effects::KinematicOffset::change(machine, 1, {0.02}, {1});
  effects::KinematicOffset::change(machine, 1, {0.03}, {2});
  EXPECT_EQ(machine.home_offset(1), 0.01);
  EXPECT_NEAR(machine.description.limbs[1].p_DE_0.x(), 0.32, 1e-15);
  EXPECT_NEAR(machine.description.limbs[1].strut, 0.83, 1e-15);
  EXPECT_EQ(machine.home_offset(0), 0.0);
  EXPECT_EQ(machine.description.limbs[0].p_DE_0.x(), 0.3);
}

TEST(KinematicOffset, OfACarriagesPlaceIsOneOfItsHome) {
  ChangedMachine machine = two_limbs(DriveKind::prismatic);
  effects::KinematicOffset::change(machine, 0, {0.02}, {1});
  EXPECT_EQ(machine.home_offset(0), 0.02);
}

}  // namespace
}  // namespace deltadyn
