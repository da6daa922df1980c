#include "deltadyn/effects/payload.hpp"

#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(Payload, NeedsItsWeightAndWhatAcceleratesIt) {
  PlateInput<double> in;
  in.acceleration << 1, 2, 3;
  in.gravity << 0, 0, -9.81;
  EXPECT_LT((effects::Payload::columns(in, {})[0] - Eigen::Vector3d(1, 2, 12.81)).norm(), 1e-12);
}

}  // namespace
}  // namespace deltadyn
