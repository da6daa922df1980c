#include "deltadyn/effects/presliding.hpp"

#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(Presliding, IsNothingInLongSlidingAndTakesCoulombsPlaceAfterAReversal) {
  using effects::Presliding;
  const Shape<double> shape{0.01, 0, 0};
  const double settled = Presliding::start(1.0, shape);
  EXPECT_EQ(Presliding::columns(settled, sliding(0.5), shape)[0], 0.0);
  // Right after the reversal the friction is still the old one: twice Coulomb's above the new one.
  EXPECT_EQ(Presliding::columns(settled, sliding(-1e-9), shape)[0], 2.0);
  const double far = Presliding::moved(settled, -1.0, sliding(-0.5), shape);
  EXPECT_NEAR(Presliding::columns(far, sliding(-0.5), shape)[0], 0.0, 1e-12);
}

}  // namespace
}  // namespace deltadyn
