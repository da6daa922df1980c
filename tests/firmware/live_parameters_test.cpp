#include "deltadyn/firmware/live_parameters.hpp"

#include <gtest/gtest.h>
#include <limits>

#include "deltadyn/dynamics/inverse_dynamics.hpp"
#include "deltadyn/firmware/feed_forward.hpp"

#include "support/matchers.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

template <class R>
class LiveParametersOf : public ::testing::Test {
 protected:
  using Layout = ParameterLayout<R, Limbs::shared>;
  Random random{5};
  Vector<double, Layout::kColumns> p = random_parameters<Layout>(random);
  LiveParameters<double, R, Limbs::shared> live{p};
};
using Robots = ::testing::Types<Delta3, LinearDelta3, Delta4, Axis, LinearAxis>;
TYPED_TEST_SUITE(LiveParametersOf, Robots);

TYPED_TEST(LiveParametersOf, AFixedPayloadIsThatOfItsPointMasses) {
  // Two masses of 0.5 kg at the ends of a rod along y, 0.2 m from its middle.
  const Vector3<double> middle(0.1, -0.2, 0.3);
  Matrix3<double> inertia = Matrix3<double>::Zero();
  inertia(0, 0) = inertia(2, 2) = 0.04;
  InertialVector<double> expected = InertialVector<double>::Zero();
  for (const double side : {-0.2, 0.2}) {
    const Vector3<double> r = middle + side * Vector3<double>::UnitY();
    InertialVector<double> point;
    point << 1, r.x(), r.y(), r.z(), r.y() * r.y() + r.z() * r.z(), r.x() * r.x() + r.z() * r.z(),
        r.x() * r.x() + r.y() * r.y(), -r.x() * r.y(), -r.y() * r.z(), -r.x() * r.z();
    expected += 0.5 * point;
  }
  EXPECT_THAT((body_at<double>(1, middle, inertia)), IsNear(expected, 1e-15));

  const int carrier = kInertialParameters * TestFixture::Layout::body(TypeParam::kTelescope  ? Body::tool
                                                                      : kHasPlate<TypeParam> ? Body::platform
                                                                                             : Body::upper_arm,
                                                                      0);
  for (int again = 0; again < 2; ++again) {  // a second payload takes the place of the first
    ASSERT_EQ(this->live.set_payload(1, middle, inertia), Status::ok);
    auto loaded = this->p;
    loaded.template segment<kInertialParameters>(carrier) += expected;
    EXPECT_THAT(this->live(), IsNear(loaded, 1e-14));
  }
  ASSERT_EQ(this->live.set_payload(0, middle), Status::ok);
  EXPECT_EQ(this->live(), this->p);
  // Moments that no body has: without mass, below 0, and one above the sum of the others.
  EXPECT_EQ(this->live.set_payload(0, middle, inertia), Status::out_of_range);
  EXPECT_EQ(this->live.set_payload(1, middle, Matrix3<double>(-inertia)), Status::out_of_range);
  inertia(1, 1) = 0.1;
  EXPECT_EQ(this->live.set_payload(1, middle, inertia), Status::out_of_range);
  EXPECT_EQ(this->live(), this->p);
}

TYPED_TEST(LiveParametersOf, APayloadAtTheOriginActsAsAMassOnThePlate) {
  if (!kHasPlate<TypeParam>) return;
  const auto geometry = random_geometry<TypeParam>(this->random);
  const auto task = random_task<TypeParam>(this->random);
  FeedForward<double, TypeParam> control(geometry, this->p);
  Vector<double, TypeParam::kDrives> q, qd, empty, loaded;
  ASSERT_EQ(control.from_task(task.z, task.zd, task.zdd, q, qd, empty), Status::ok);
  ASSERT_EQ(control.set_payload(2, Vector3<double>::Zero()), Status::ok);
  ASSERT_EQ(control.from_task(task.z, task.zd, task.zdd, q, qd, loaded), Status::ok);
  Motion<double, TypeParam> motion;
  ASSERT_EQ(motion_from_task(geometry, task.z, task.zd, task.zdd, motion), Status::ok);
  const Vector3<double> force = 2 * (task.zdd.template head<3>() - geometry.gravity);
  EXPECT_THAT(Eigen::VectorXd(loaded - empty),
              IsNear(Eigen::VectorXd(motion.posture.J_plate.template topRows<3>().transpose() * force), 1e-11));
}

TYPED_TEST(LiveParametersOf, SetsTheFrictionOfOneJoint) {
  for (int joint = 0; joint < TestFixture::Layout::kFrictionJoints; ++joint) {
    ASSERT_EQ(this->live.set_friction(joint, 0.25, 4), Status::ok);
    this->p(TestFixture::Layout::viscous(joint)) = 0.25;
    this->p(TestFixture::Layout::coulomb(joint)) = 4;
    EXPECT_EQ(this->live(), this->p);
  }
}

TYPED_TEST(LiveParametersOf, RefusesWhatCannotBe) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const Vector3<double> here(0.1, 0.1, 0.1);
  for (const double mass : {-1.0, nan, infinity}) EXPECT_EQ(this->live.set_payload(mass, here), Status::out_of_range);
  EXPECT_EQ(this->live.set_payload(1, Vector3<double>(nan, 0, 0)), Status::out_of_range);
  EXPECT_EQ(this->live.set_payload(1, here, Matrix3<double>::Constant(infinity)), Status::out_of_range);
  for (const double bad : {-1.0, nan, infinity}) {
    EXPECT_EQ(this->live.set_friction(0, bad, 1), Status::out_of_range);
    EXPECT_EQ(this->live.set_friction(0, 1, bad), Status::out_of_range);
  }
  EXPECT_EQ(this->live.set_friction(-1, 1, 1), Status::out_of_range);
  EXPECT_EQ(this->live.set_friction(TestFixture::Layout::kFrictionJoints, 1, 1), Status::out_of_range);
  EXPECT_EQ(this->live(), this->p);
}

}  // namespace
}  // namespace deltadyn
