#include "deltadyn/kinematics/tool_point.hpp"

#include <gtest/gtest.h>

#include "deltadyn/kinematics/inner_joint.hpp"
#include "deltadyn/model/robot_types.hpp"
#include "deltadyn/runtime/geometry_of.hpp"

#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

/// A smooth motion of the plate and the turn, as a function of time.
template <class R>
Motion<double, R> motion_at(const Geometry<double, R>& geometry, double t) {
  Vector<double, R::kDrives> z, zd, zdd;
  for (int i = 0; i < R::kDrives; ++i) {
    const double a = i < 3 ? 0.05 : 0.4, w = 2.0 + i, middle = i == 2 ? -0.75 : 0.0;
    z(i) = middle + a * std::sin(w * t + i);
    zd(i) = a * w * std::cos(w * t + i);
    zdd(i) = -a * w * w * std::sin(w * t + i);
  }
  Motion<double, R> motion;
  EXPECT_EQ((motion_from_task<double, R>(geometry, z, zd, zdd, motion)), Status::ok);
  return motion;
}

template <class R>
class ToolPoint : public ::testing::Test {};
using FourLimbTypes = ::testing::Types<H4, I4, Par4, LinearPar4>;
TYPED_TEST_SUITE(ToolPoint, FourLimbTypes);

TYPED_TEST(ToolPoint, RatesAreTheSlopesOfThePosition) {
  using R = TypeParam;
  const auto geometry = geometry_of<double, R>(four_limb_description(R::kName, R::kDrive));
  constexpr double kStep = 1e-5;
  for (double t = 0; t < 3; t += 0.37) {
    const Motion<double, R> motion = motion_at<R>(geometry, t);
    const auto now = tool_point(geometry, motion);
    const auto before = tool_point(geometry, motion_at<R>(geometry, t - kStep));
    const auto after = tool_point(geometry, motion_at<R>(geometry, t + kStep));
    EXPECT_LT((now.velocity - (after.position - before.position) / (2 * kStep)).norm(), 1e-8);
    EXPECT_LT((now.acceleration - (after.velocity - before.velocity) / (2 * kStep)).norm(), 1e-7);
    EXPECT_LT((now.velocity - now.J * motion.qd).norm(), 1e-12);
  }
}

TYPED_TEST(ToolPoint, TheInnerJointTurnsByTheta) {
  using R = TypeParam;
  const auto geometry = geometry_of<double, R>(four_limb_description(R::kName, R::kDrive));
  for (double t = 0; t < 3; t += 0.37) {
    const Motion<double, R> motion = motion_at<R>(geometry, t);
    const InnerJoint<double, R> joint = inner_joint(motion);
    EXPECT_NEAR(joint.position * geometry.yaw_ratio, motion.posture.z(3), 1e-14);
    EXPECT_NEAR(joint.rate * geometry.yaw_ratio, motion.zd(3), 1e-12);
    EXPECT_NEAR(joint.acceleration * geometry.yaw_ratio, motion.zdd(3), 1e-10);
    EXPECT_NEAR(joint.rate, joint.J.dot(motion.qd), 1e-12);
  }
}

TEST(ToolPointOnAHalf, MovesWithTheHalfThatCarriesIt) {
  const auto geometry = geometry_of<double, Par4>(four_limb_description("par4"));  // tool on half plate 1
  const Motion<double, Par4> motion = motion_at<Par4>(geometry, 0.4);
  const auto half = part_pose(geometry.parts[0], motion.posture.z(3), geometry.yaw_ratio);
  EXPECT_LT((tool_point(geometry, motion).position - motion.posture.z.head<3>() - half.p.value).norm(), 1e-15);
}

}  // namespace
}  // namespace deltadyn
