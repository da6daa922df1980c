#pragma once

/// \file
/// A random robot with random parameters in a random motion, drawn again and again from one seed.

#include <gtest/gtest.h>

#include "deltadyn/kinematics/motion.hpp"

#include "support/core_instances.hpp"
#include "support/random_robot.hpp"

namespace deltadyn::testing_support {

template <class R>
struct DrawnMotion {
  using Layout = ParameterLayout<R, Limbs::individual>;
  using Drives = Vector<double, R::kDrives>;
  using Square = Matrix<double, R::kDrives, R::kDrives>;

  explicit DrawnMotion(std::uint64_t seed) : random(seed) {}

  void next() {
    geometry = random_geometry<R>(random);
    task = random_task<R>(random, geometry.yaw_ratio);
    p = random_parameters<Layout>(random);
    ASSERT_EQ(motion_from_task(geometry, task.z, task.zd, task.zdd, motion), Status::ok);
  }
  /// Without friction and offsets only bodies and rotors are left.
  void remove_friction_and_offsets() {
    p.template segment<2 * Layout::kFrictionJoints>(Layout::kFriction).setZero();
    p.template segment<R::kDrives>(Layout::kOffset).setZero();
  }

  Random random;
  Geometry<double, R> geometry;
  RandomTask<R> task;
  Motion<double, R> motion;
  Vector<double, Layout::kColumns> p;
};

/// Types of all robots for typed tests.
using AllRobots = ::testing::Types<Delta3, LinearDelta3, Delta4, TurningPlate, Axis, LinearAxis>;

}  // namespace deltadyn::testing_support
