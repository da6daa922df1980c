#include "deltadyn/runtime/workspace.hpp"

#include <gtest/gtest.h>

#include "deltadyn/runtime/error.hpp"

#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

class WorkspaceOf : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Types, WorkspaceOf, ::testing::Values("delta3", "linear-delta3", "delta4"));

TEST_P(WorkspaceOf, DrawsReachableStatesInItsBall) {
  const auto robot = make_robot(delta_description(GetParam()));
  WorkspaceSampler sampler(*robot, 5);
  Eigen::VectorXd q, qd, qdd;
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
  EXPECT_LT(sampler.ball().centre.z(), 0) << "the plate hangs below the base";
  for (int k = 0; k < 500; ++k) {
    sampler.next(q, qd, qdd);
    TaskState task;
    ASSERT_EQ(robot->to_task(q, qd, qdd, task), Status::ok);
    EXPECT_LE((task.z.head<3>() - sampler.ball().centre).norm(), sampler.ball().radius + 1e-9);
    low = low.cwiseMin(task.z.head<3>());
    high = high.cwiseMax(task.z.head<3>());
  }
  EXPECT_GT((high - low).minCoeff(), 1.5 * sampler.ball().radius) << "the ball should be filled";
}

TEST_P(WorkspaceOf, DrawsTheSameWithTheSameSeed) {
  const auto robot = make_robot(delta_description(GetParam()));
  WorkspaceSampler one(*robot, 5), two(*robot, 5), three(*robot, 6);
  Eigen::VectorXd q1, q2, q3, qd1, qd2, qdd1, qdd2;
  one.next(q1, qd1, qdd1);
  two.next(q2, qd2, qdd2);
  three.next(q3);
  EXPECT_EQ(q1, q2);
  EXPECT_EQ(qd1, qd2);
  EXPECT_EQ(qdd1, qdd2);
  EXPECT_NE(q1, q3);
}

TEST(Workspace, OfAnAxisIsItsDrive) {
  const auto robot = make_robot(axis_description(DriveKind::prismatic));
  WorkspaceSampler sampler(*robot);
  Eigen::VectorXd q, qd, qdd;
  sampler.next(q, qd, qdd);
  EXPECT_EQ(q.size(), 1);
  EXPECT_NE(qdd(0), 0);
}

// On rails the reach ends where the travel does, beside the struts or along the rails: the ball stays inside.
TEST(Workspace, OnRailsKeepsInsideTheTravel) {
  RobotDescription robot = delta_description("linear-delta3");
  const WorkspaceBall wide = WorkspaceSampler(*make_robot(robot)).ball();
  EXPECT_NEAR(wide.radius, 0.4 * robot.limbs.front().strut, 1e-9);
  for (DriveLimits& limits : robot.limits) {
    limits.lower = -0.36 * robot.limbs.front().strut;
    limits.upper = 0.36 * robot.limbs.front().strut;
  }
  const auto narrow = make_robot(robot);
  const WorkspaceBall ball = WorkspaceSampler(*narrow).ball();
  EXPECT_LT(ball.radius, 0.9 * wide.radius);
  Eigen::VectorXd q(3);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      ASSERT_EQ(narrow->inverse_kinematics(ball.centre + side * ball.radius * Eigen::Vector3d::Unit(axis), q),
                Status::ok);
      EXPECT_GE(q.minCoeff(), robot.limits[0].lower);
      EXPECT_LE(q.maxCoeff(), robot.limits[0].upper);
    }
  }
}

TEST(Workspace, RefusesARobotThatReachesNothing) {
  Lengths lengths;
  lengths.strut = 0.1;
  lengths.upper_arm = 0.1;
  lengths.base_radius = 0.55;
  const auto robot = make_robot(delta_description("delta3", lengths));
  EXPECT_THROW(WorkspaceSampler sampler(*robot), Error);
}

}  // namespace
}  // namespace deltadyn
