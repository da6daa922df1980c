#include "deltadyn/model/parameter_layout.hpp"

#include <gtest/gtest.h>
#include <set>
#include <vector>

namespace deltadyn {
namespace {

template <class L>
class Layout : public ::testing::Test {};

template <class R, Limbs kSharing>
struct Of : ParameterLayout<R, kSharing> {
  using Robot = R;
};
using Layouts =
    ::testing::Types<Of<Delta3, Limbs::shared>, Of<Delta3, Limbs::individual>, Of<LinearDelta3, Limbs::individual>,
                     Of<Delta4, Limbs::shared>, Of<Delta4, Limbs::individual>, Of<Axis, Limbs::shared>>;
TYPED_TEST_SUITE(Layout, Layouts);

TYPED_TEST(Layout, GivesEveryColumnToOneParameter) {
  using L = TypeParam;
  using R = typename L::Robot;
  std::set<int> bodies;
  for (int i = 0; i < R::kLimbs; ++i) {
    bodies.insert(L::body(Body::upper_arm, i));
    if (kHasPlate<R>) bodies.insert(L::body(Body::strut, i));
  }
  for (int k = 0; k < R::kPlateParts; ++k) bodies.insert(L::body(Body::platform, k));
  if (R::kTelescope) {
    for (const Body body : {Body::tool, Body::telescope_upper, Body::telescope_lower}) bodies.insert(L::body(body, 0));
  }
  std::vector<int> columns;
  for (const int body : bodies) {
    for (int k = 0; k < kInertialParameters; ++k) columns.push_back(kInertialParameters * body + k);
  }
  for (int j = 0; j < L::kFrictionJoints; ++j) {
    columns.push_back(L::viscous(j));
    columns.push_back(L::coulomb(j));
  }
  for (int j = 0; j < 2 * R::kDrives; ++j) columns.push_back(L::kRotorInertia + j);
  ASSERT_EQ(columns.size(), static_cast<std::size_t>(L::kColumns));
  for (int k = 0; k < L::kColumns; ++k) EXPECT_EQ(columns[static_cast<std::size_t>(k)], k);
}

TEST(ParameterLayout, HasThePapersCounts) {
  // Without rotor inertias and offsets, which are extra.
  EXPECT_EQ((ParameterLayout<Delta4, Limbs::shared>::kRotorInertia), 70);
  EXPECT_EQ((ParameterLayout<Delta4, Limbs::individual>::kRotorInertia), 110);
  EXPECT_EQ((ParameterLayout<Delta3, Limbs::shared>::kRotorInertia), 36);
  EXPECT_EQ((ParameterLayout<Axis, Limbs::shared>::kRotorInertia), 12);
}

}  // namespace
}  // namespace deltadyn
