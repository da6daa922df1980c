#include "deltadyn/effects/wave.hpp"

#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(Wave, StartsAtItsCosine) {
  const Wave<float> parts = wave(0.0F, 7.0F);
  EXPECT_EQ(parts.cosine, 1.0F);
  EXPECT_EQ(parts.sine, 0.0F);
}

}  // namespace
}  // namespace deltadyn
