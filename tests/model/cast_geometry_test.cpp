#include "deltadyn/model/cast_geometry.hpp"

#include <gtest/gtest.h>

#include "support/matchers.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

template <class R>
class CastGeometry : public ::testing::Test {};
using Robots = ::testing::Types<Delta3, LinearDelta3, Delta4, TurningPlate, Axis, LinearAxis>;
TYPED_TEST_SUITE(CastGeometry, Robots);

TYPED_TEST(CastGeometry, CarriesEveryNumberOver) {
  Random random(5);
  auto from = random_geometry<TypeParam>(random);
  from.limbs[0].elbow = -1;
  const auto to = cast_geometry<float>(from);
  const auto near = [](const Vector3<double>& v) { return IsNear(v, 1e-6); };
  for (int i = 0; i < TypeParam::kLimbs; ++i) {
    const LimbGeometry<double>& limb = from.limbs[i];
    EXPECT_FLOAT_EQ(to.limbs[i].azimuth, static_cast<float>(limb.azimuth));
    EXPECT_THAT(to.limbs[i].p_WD, near(limb.p_WD));
    EXPECT_THAT(to.limbs[i].axis_L, near(limb.axis_L));
    EXPECT_THAT(to.limbs[i].p_DE_0, near(limb.p_DE_0));
    EXPECT_FLOAT_EQ(to.limbs[i].strut, static_cast<float>(limb.strut));
    EXPECT_FLOAT_EQ(to.limbs[i].strut_spacing, static_cast<float>(limb.strut_spacing));
    EXPECT_THAT(to.limbs[i].p_BA, near(limb.p_BA));
    EXPECT_EQ(to.limbs[i].part, limb.part);
    EXPECT_FLOAT_EQ(to.limbs[i].elbow, static_cast<float>(limb.elbow));
  }
  for (int k = 0; k < TypeParam::kPlateParts; ++k) {
    EXPECT_THAT(to.parts[k].c, near(from.parts[k].c));
    EXPECT_THAT(to.parts[k].a, near(from.parts[k].a));
    EXPECT_THAT(to.parts[k].b, near(from.parts[k].b));
    EXPECT_FLOAT_EQ(to.parts[k].kappa, static_cast<float>(from.parts[k].kappa));
  }
  EXPECT_THAT(to.telescope.p_WU, near(from.telescope.p_WU));
  EXPECT_THAT(to.telescope.p_BV, near(from.telescope.p_BV));
  EXPECT_THAT(to.gravity, near(from.gravity));
}

// What a float holds exactly comes back bit by bit.
TYPED_TEST(CastGeometry, ThereAndBackIsTheSame) {
  Random random(6);
  const auto single = cast_geometry<float>(random_geometry<TypeParam>(random));
  const auto back = cast_geometry<float>(cast_geometry<double>(single));
  for (int i = 0; i < TypeParam::kLimbs; ++i) {
    EXPECT_EQ(back.limbs[i].p_WD, single.limbs[i].p_WD);
    EXPECT_EQ(back.limbs[i].strut, single.limbs[i].strut);
  }
  EXPECT_EQ(back.gravity, single.gravity);
}

}  // namespace
}  // namespace deltadyn
