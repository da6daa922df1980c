#include "deltadyn/effects/backlash.hpp"

#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(Backlash, IsFreeOnlyWhileTheGapIsCrossed) {
  using effects::Backlash;
  const Shape<double> gap{0.01, 0, 0};
  double place = Backlash::start(1.0, gap);
  const auto missing = [&](double step, double load) {
    const JointInput<double> in = sliding(0.0, load);
    place = Backlash::moved(place, step, in, gap);
    return Backlash::columns(place, in, gap)[0];
  };
  EXPECT_EQ(missing(0.1, 1.0), 0.0);
  EXPECT_EQ(missing(-0.004, -3.0), 3.0);
  EXPECT_EQ(missing(-0.004, -3.0), 3.0);
  EXPECT_EQ(missing(-0.004, -3.0), 0.0);
  EXPECT_EQ(missing(-1.0, -3.0), 0.0);
}

}  // namespace
}  // namespace deltadyn
