#include "deltadyn/kinematics/inverse.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "support/core_instances.hpp"
#include "support/oracle_of.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

template <class R>
class InverseKinematics : public ::testing::Test {
 protected:
  using DriveVector = Vector<double, R::kDrives>;
  Random random{1};
};

using Robots = ::testing::Types<Delta3, LinearDelta3, Delta4, TurningPlate>;
TYPED_TEST_SUITE(InverseKinematics, Robots);

// Scanning the loop equation finds two drive positions for each limb; elbow +1 is the one that turns the arm less far
// down (elbow outwards) or leaves the carriage behind, -1 the other.
TYPED_TEST(InverseKinematics, FindsTheDrivePositionOfEitherElbow) {
  for (int trial = 0; trial < 20; ++trial) {
    auto geometry = random_geometry<TypeParam>(this->random);
    const auto task = random_task<TypeParam>(this->random);
    const auto mechanism = oracle_of(geometry);
    const auto y = numbers(task.z);
    typename TestFixture::DriveVector outer, inner;
    ASSERT_EQ(inverse_kinematics(geometry, task.z, outer), Status::ok);
    for (auto& limb : geometry.limbs) limb.elbow = -1;
    ASSERT_EQ(inverse_kinematics(geometry, task.z, inner), Status::ok);
    for (int i = 0; i < TypeParam::kLimbs; ++i) {
      // One turn that begins below every outer position, so that the inner one follows; the library wraps it to (-pi,
      // pi].
      constexpr double kTurn = 6.283185307179586;
      const auto roots = oracles::drive_roots(mechanism, static_cast<std::size_t>(i), y, -1.2L, -1.2L + kTurn);
      ASSERT_EQ(roots.size(), 2U);
      EXPECT_NEAR(outer(i), static_cast<double>(roots[0]), 1e-13);
      EXPECT_NEAR(std::remainder(inner(i) - static_cast<double>(roots[1]), kTurn), 0, 1e-13);
    }
  }
}

TEST(InverseKinematicsOfDelta4, KeepsTheTurnOfTheTelescope) {
  Random random(1);
  const auto geometry = random_geometry<Delta4>(random);
  auto task = random_task<Delta4>(random);
  task.z(3) = 17.5;  // more than two turns
  Vector<double, 4> q;
  ASSERT_EQ(inverse_kinematics(geometry, task.z, q), Status::ok);
  EXPECT_EQ(q(3), 17.5);
}

TYPED_TEST(InverseKinematics, SaysWhenAPoseIsOutOfReach) {
  const auto geometry = random_geometry<TypeParam>(this->random);
  const auto task = random_task<TypeParam>(this->random);
  for (const double x : {-5.0, 5.0}) {
    auto z = task.z;
    z(0) = x;
    typename TestFixture::DriveVector q;
    EXPECT_EQ(inverse_kinematics(geometry, z, q), Status::unreachable);
  }
}

TYPED_TEST(InverseKinematics, RefusesWhatIsNotFinite) {
  const auto geometry = random_geometry<TypeParam>(this->random);
  const auto task = random_task<TypeParam>(this->random);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (int i = 0; i < TypeParam::kDrives; ++i) {
      auto z = task.z;
      z(i) = bad;
      typename TestFixture::DriveVector q;
      EXPECT_EQ(inverse_kinematics(geometry, z, q), Status::out_of_range) << "entry " << i;
    }
  }
}

TEST(RevoluteDriveAngle, PutsTheElbowOutwards) {
  LimbGeometry<double> limb;
  limb.p_DE_0 = Vector3<double>(0.4, 0, 0);
  limb.strut = 0.5;
  // 3-4-5 triangle: attachment 0.3 m below the drive; the elbow stands 0.4 m outwards or inwards at the drive's height.
  const Vector3<double> p_DA(0, 0, -0.3);
  double q = 1;
  ASSERT_EQ(revolute_drive_angle(limb, p_DA, q), Status::ok);
  EXPECT_NEAR(q, 0, 1e-15);
  limb.elbow = -1;
  ASSERT_EQ(revolute_drive_angle(limb, p_DA, q), Status::ok);
  EXPECT_NEAR(std::abs(q), 3.14159265358979323846, 1e-15);
}

TEST(RevoluteDriveAngle, StretchesAsFarAsItCan) {
  LimbGeometry<double> limb;
  limb.p_DE_0 = Vector3<double>(0.5, 0, 0);
  limb.strut = 1;
  double q = 0;
  ASSERT_EQ(revolute_drive_angle(limb, Vector3<double>(0, 0, -1.5), q), Status::ok);
  EXPECT_NEAR(q, 1.5707963267948966, 1e-7);  // straight down, at the very edge of the reach
  EXPECT_EQ(revolute_drive_angle(limb, Vector3<double>(0, 0, -1.5001), q), Status::unreachable);
  EXPECT_EQ(revolute_drive_angle(limb, Vector3<double>(0, 0, -0.4999), q), Status::unreachable);  // too near
}

TEST(RevoluteDriveAngle, RefusesAnAttachmentOnTheAxis) {
  LimbGeometry<double> limb;
  limb.p_DE_0 = Vector3<double>(1, 0, 0);
  limb.strut = 1;
  double q = 0;
  EXPECT_EQ(revolute_drive_angle(limb, Vector3<double>(0, 0, 0), q), Status::unreachable);  // every angle or none
}

TEST(PrismaticDrivePosition, LeavesTheCarriageBehindThePlate) {
  LimbGeometry<double> limb;
  limb.axis_L = -Vector3<double>::UnitZ();
  limb.strut = 0.5;
  double q = 0;
  ASSERT_EQ(prismatic_drive_position(limb, Vector3<double>(-0.3, 0, -1), q), Status::ok);
  EXPECT_NEAR(q, 0.6, 1e-15);
  limb.elbow = -1;
  ASSERT_EQ(prismatic_drive_position(limb, Vector3<double>(-0.3, 0, -1), q), Status::ok);
  EXPECT_NEAR(q, 1.4, 1e-15);
  EXPECT_EQ(prismatic_drive_position(limb, Vector3<double>(-0.51, 0, -1), q), Status::unreachable);
}

TEST(InverseKinematicsOfAnAxis, IsTheIdentity) {
  const Vector<double, 1> z(0.4);
  Vector<double, 1> q;
  EXPECT_EQ((inverse_kinematics<double, Axis>({}, z, q)), Status::ok);
  EXPECT_EQ(q, z);
}

}  // namespace
}  // namespace deltadyn
