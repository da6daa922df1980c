#include "deltadyn/trajectory/limit_check.hpp"

#include <cmath>
#include <gmock/gmock.h>

#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

/// q = size sin(w t) for one second on an axis whose velocity may be 10.
SmoothMotion swing(double size, double w) {
  return {1.0, [size, w](double t) -> TaskState {
            return {Eigen::VectorXd::Constant(1, size * std::sin(w * t)),
                    Eigen::VectorXd::Constant(1, size * w * std::cos(w * t)),
                    Eigen::VectorXd::Constant(1, -size * w * w * std::sin(w * t))};
          }};
}

class LimitCheckTest : public ::testing::Test {
 protected:
  LimitCheckTest()
      : robot(make_robot(testing_support::axis_description(DriveKind::revolute))), limits(robot->description()) {
    limits.qd(0) = 10;
    limits.q_lower(0) = -2;
    limits.q_upper(0) = 2;
  }
  std::unique_ptr<Robot> robot;
  MotionLimits limits;
};

// However the samples fall, the load is never below the true largest one, and close to it.
TEST_F(LimitCheckTest, CoversThePeaksBetweenTheSamples) {
  for (int samples = 37; samples < 400; samples += 13) {
    for (const double w : {7.1, 11.3, 12.9}) {
      const LimitCheck check = check_limits(*robot, limits, swing(1, w), samples);
      ASSERT_EQ(check.uses.size(), 2U);
      EXPECT_GE(check.uses[0].load, 0.5 - 1e-12);  // position 1 of 2, reached inside the second
      EXPECT_LE(check.uses[0].load, 0.5 * (1 + w * w / samples / samples));
      EXPECT_GE(check.uses[1].load, w / 10 - 1e-12);
      EXPECT_NEAR(std::abs(check.uses[1].value), w, w * w * w / samples / samples);
    }
  }
}

// The torque of a rotor with Coulomb friction is largest just before or after it turns back, where it jumps: the sum of
// both parts is approached there, whether a sample falls near or not.
TEST_F(LimitCheckTest, CoversTheJumpOfCoulombFriction) {
  constexpr double kInertia = 0.2, kCoulomb = 1.5, kSize = 0.5;
  ParameterOptions options;
  options.rotor_inertia = {1};
  const auto rotor = make_robot(testing_support::axis_description(DriveKind::revolute), options);
  MotionLimits torque(rotor->description());
  torque.parameters = Eigen::VectorXd::Zero(rotor->parameters());
  for (std::size_t k = 0; k < rotor->parameter_names().size(); ++k) {
    const std::string& name = rotor->parameter_names()[k];
    if (name.ends_with(".coulomb")) torque.parameters(static_cast<Eigen::Index>(k)) = kCoulomb;
    if (name.ends_with(".rotor_inertia")) torque.parameters(static_cast<Eigen::Index>(k)) = kInertia;
  }
  torque.tau(0) = 10;
  for (int samples = 101; samples < 900; samples += 37) {
    for (const double w : {7.1, 11.3, 12.9}) {
      const LimitCheck check = check_limits(*rotor, torque, swing(kSize, w), samples);
      ASSERT_EQ(check.tightest().limit.name, "drive 1 torque");
      const double largest = kInertia * kSize * w * w + kCoulomb;
      EXPECT_GE(check.tightest().load, largest / 10 - 1e-12);
      EXPECT_LE(check.tightest().load, largest / 10 * (1 + w * w / samples / samples));
    }
  }
}

TEST_F(LimitCheckTest, NamesTheTightestLimitAndWhen) {
  const LimitCheck check = check_limits(*robot, limits, swing(1.9, 6), 1000);
  EXPECT_EQ(check.tightest().limit.name, "drive 1 velocity");
  EXPECT_NEAR(check.margin(), 1 - 1.14, 1e-4);
  LimitCheck sum = check_limits(*robot, limits, swing(0.1, 1), 1000);
  sum.merge(check, 5.0);
  EXPECT_EQ(sum.tightest().limit.name, "drive 1 velocity");
  EXPECT_GE(sum.tightest().time_s, 5.0);
  EXPECT_NEAR(sum.margin(), check.margin(), 1e-15);
}

TEST_F(LimitCheckTest, SaysWhereTheRobotCannotGo) {
  const auto delta = make_robot(testing_support::delta_description("delta3"));
  const SmoothMotion away{
      1.0, [](double t) -> TaskState {
        return {Eigen::Vector3d(0, 0, -0.9 - 3 * t), Eigen::Vector3d(0, 0, -3), Eigen::Vector3d::Zero()};
      }};
  const LimitCheck check = check_limits(*delta, MotionLimits(delta->description()), away, 100);
  EXPECT_FALSE(check.reachable);
  EXPECT_LT(check.margin(), 0);
}

}  // namespace
}  // namespace deltadyn
