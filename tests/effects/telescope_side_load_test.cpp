#include "deltadyn/effects/telescope_side_load.hpp"

#include <gtest/gtest.h>

#include "sliding.hpp"

namespace deltadyn {
namespace {

TEST(TelescopeSideLoad, ResistsInProportionToTheSideLoad) {
  JointInput<double> in = sliding(-0.3);
  in.side_load = 5;
  EXPECT_EQ(effects::TelescopeSideLoad::columns(in, {})[0], -5.0);
}

}  // namespace
}  // namespace deltadyn
