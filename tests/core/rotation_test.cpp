#include "deltadyn/core/rotation.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "support/matchers.hpp"

namespace deltadyn {
namespace {

using testing_support::IsNear;

template <class T>
class Rotation : public ::testing::Test {
 protected:
  static constexpr double kTolerance = sizeof(T) == 4 ? 1e-6 : 1e-15;
};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(Rotation, Scalars);

TYPED_TEST(Rotation, AgreesWithEigensAngleAxis) {
  for (const TypeParam angle : {TypeParam(-2.5), TypeParam(0), TypeParam(0.3), TypeParam(3.1)}) {
    const SinCos<TypeParam> a(angle);
    const auto about = [&](const Vector3<TypeParam>& axis) {
      return Eigen::AngleAxis<TypeParam>(angle, axis).toRotationMatrix();
    };
    EXPECT_THAT(rot_x(a), IsNear(about(Vector3<TypeParam>::UnitX()), this->kTolerance));
    EXPECT_THAT(rot_y(a), IsNear(about(Vector3<TypeParam>::UnitY()), this->kTolerance));
    EXPECT_THAT(rot_z(a), IsNear(about(Vector3<TypeParam>::UnitZ()), this->kTolerance));
  }
}

TYPED_TEST(Rotation, SkewIsTheCrossProduct) {
  const Vector3<TypeParam> v(1, -2, 3), w(4, 5, TypeParam(-0.5));
  EXPECT_EQ((skew(v) * w).eval(), v.cross(w));
  EXPECT_EQ(cross_z(w), (Vector3<TypeParam>::UnitZ().cross(w)));
}

TYPED_TEST(Rotation, SinCosStartsAtAngleZero) {
  const SinCos<TypeParam> a;
  EXPECT_EQ(rot_y(a), Matrix3<TypeParam>::Identity());
}

}  // namespace
}  // namespace deltadyn
