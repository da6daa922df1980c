#include "deltadyn/kinematics/forward.hpp"

#include <gtest/gtest.h>
#include <limits>

#include "deltadyn/kinematics/inverse.hpp"

#include "support/matchers.hpp"
#include "support/oracle_of.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

template <class R, class T>
struct Case {
  using Robot = R;
  using Scalar = T;
};

template <class C>
class ForwardKinematics : public ::testing::Test {
 protected:
  Random random{2};
};

using Cases = ::testing::Types<Case<Delta3, double>, Case<LinearDelta3, double>, Case<Delta4, double>,
                               Case<Delta3, float>, Case<LinearDelta3, float>, Case<Delta4, float>>;
TYPED_TEST_SUITE(ForwardKinematics, Cases);

TYPED_TEST(ForwardKinematics, UndoesInverseKinematics) {
  using R = typename TypeParam::Robot;
  using T = typename TypeParam::Scalar;
  for (int trial = 0; trial < 500; ++trial) {
    const auto geometry = cast_geometry<T>(random_geometry<R>(this->random));
    const Vector<T, R::kDrives> z = random_task<R>(this->random).z.template cast<T>();
    Vector<T, R::kDrives> q, back;
    ASSERT_EQ(inverse_kinematics(geometry, z, q), Status::ok);
    ASSERT_EQ(forward_kinematics(geometry, q, back), Status::ok);
    EXPECT_THAT(back, IsNear(z, 20 * static_cast<double>(std::numeric_limits<T>::epsilon()))) << "trial " << trial;
  }
}

TYPED_TEST(ForwardKinematics, SolvesTheLoopEquationsAsNewtonDoes) {
  using R = typename TypeParam::Robot;
  using T = typename TypeParam::Scalar;
  for (int trial = 0; trial < 50; ++trial) {
    const auto geometry = random_geometry<R>(this->random);
    const auto task = random_task<R>(this->random);
    Vector<double, R::kDrives> q;
    ASSERT_EQ(inverse_kinematics(geometry, task.z, q), Status::ok);
    for (int i = 0; i < R::kDrives; ++i) q(i) += this->random.uniform(-0.05, 0.05);
    Vector<T, R::kDrives> z;
    ASSERT_EQ(forward_kinematics<T>(cast_geometry<T>(geometry), q.template cast<T>(), z), Status::ok);
    const auto y = to_vector<3>(oracles::plate(oracle_of(geometry), numbers(q), numbers(task.z)));
    EXPECT_THAT((z.template head<3>().eval()), IsNear(y, 20 * static_cast<double>(std::numeric_limits<T>::epsilon())));
  }
}

TYPED_TEST(ForwardKinematics, SaysWhenTheStrutsDoNotMeet) {
  using R = typename TypeParam::Robot;
  using T = typename TypeParam::Scalar;
  auto geometry = cast_geometry<T>(random_geometry<R>(this->random));
  for (auto& limb : geometry.limbs) limb.strut = T(0.1);
  Vector<T, R::kDrives> z;
  EXPECT_EQ((forward_kinematics<T, R>(geometry, Vector<T, R::kDrives>::Zero(), z)), Status::unreachable);
}

TYPED_TEST(ForwardKinematics, RefusesWhatIsNotFinite) {
  using R = typename TypeParam::Robot;
  using T = typename TypeParam::Scalar;
  const auto geometry = cast_geometry<T>(random_geometry<R>(this->random));
  for (int i = 0; i < R::kDrives; ++i) {
    Vector<T, R::kDrives> q = Vector<T, R::kDrives>::Zero(), z;
    q(i) = std::numeric_limits<T>::quiet_NaN();
    EXPECT_EQ((forward_kinematics<T, R>(geometry, q, z)), Status::out_of_range);
    Posture<T, R> posture;
    EXPECT_EQ((posture_from_drives<T, R>(geometry, q, posture)), Status::out_of_range);
  }
}

TEST(LowerIntersection, OfThreeSpheresTakesTheLowerPoint) {
  const Vector3<double> centres[3] = {{3, 0, 0}, {0, 4, 0}, {-3, 0, 0}};
  const double radii[3] = {5, 4, 5};
  Vector3<double> p;
  ASSERT_EQ(lower_intersection(centres, radii, p), Status::ok);
  EXPECT_THAT(p, IsNear(Vector3<double>(0, 4, 0) + Vector3<double>(0, -2, -std::sqrt(12.0)), 1e-14));
}

TEST(LowerIntersection, DoesNotDependOnTheOrder) {
  Random random(4);
  for (int trial = 0; trial < 100; ++trial) {
    const Vector3<double> a = random.cube(1), b = random.cube(1), c = random.cube(1), p(0.1, 0.2, -3);
    const double ra = (p - a).norm(), rb = (p - b).norm(), rc = (p - c).norm();
    const Vector3<double> one[3] = {a, b, c}, two[3] = {c, b, a};
    const double r_one[3] = {ra, rb, rc}, r_two[3] = {rc, rb, ra};
    Vector3<double> p_one, p_two;
    ASSERT_EQ(lower_intersection(one, r_one, p_one), Status::ok);
    ASSERT_EQ(lower_intersection(two, r_two, p_two), Status::ok);
    EXPECT_THAT(p_one, IsNear(p_two, 1e-10));
  }
}

TEST(LowerIntersection, IsSingularForCentresInLine) {
  const Vector3<double> in_line[3] = {{0, 0, 0}, {1, 0, 0}, {3, 0, 0}};
  const Vector3<double> same[3] = {{0, 0, 0}, {0, 0, 0}, {3, 0, 0}};
  const double radii[3] = {5, 5, 5};
  Vector3<double> p;
  EXPECT_EQ(lower_intersection(in_line, radii, p), Status::singular);
  EXPECT_EQ(lower_intersection(same, radii, p), Status::singular);
}

TEST(LowerIntersection, IsUnreachableForSpheresApart) {
  const Vector3<double> centres[3] = {{10, 0, 0}, {0, 10, 0}, {-10, 0, 0}};
  const double radii[3] = {5, 5, 5};
  Vector3<double> p;
  EXPECT_EQ(lower_intersection(centres, radii, p), Status::unreachable);
}

}  // namespace
}  // namespace deltadyn
