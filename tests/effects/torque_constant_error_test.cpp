#include "deltadyn/effects/torque_constant_error.hpp"

#include <gtest/gtest.h>

namespace deltadyn {
namespace {

TEST(TorqueConstantError, ScalesWhatIsRecorded) {
  const Eigen::VectorXd torque = Eigen::Vector3d(4, 7, -7);
  EXPECT_LT((effects::TorqueConstantError::record(torque, 1e-3, 0.05, {}) - 1.05 * torque).norm(), 1e-12);
}

}  // namespace
}  // namespace deltadyn
