#include "deltadyn/runtime/drive_inertia.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deltadyn/runtime/error.hpp"

#include "identification/synthetic_log.hpp"

namespace deltadyn {
namespace {

TEST(DriveInertia, IsTheDiagonalOfTheMassMatrixInTheMiddleOfTheLimits) {
  RobotDescription description = testing_support::delta_description("delta3");
  for (DriveLimits& limits : description.limits) {
    limits.lower = -0.2;
    limits.upper = 0.8;
  }
  const auto robot = make_robot(description);
  const Eigen::VectorXd p = testing_support::delta_truth(*robot);
  Eigen::MatrixXd M(3, 3);
  ASSERT_EQ(robot->mass_matrix(Eigen::Vector3d::Constant(0.3), p, M), Status::ok);
  EXPECT_LT((drive_inertia(*robot, p) - M.diagonal()).norm(), 1e-14);
}

TEST(DriveInertia, OfARobotThatDoesNotCloseIsAnErrorWithItsCause) {
  const auto robot = make_robot(testing_support::delta_description("delta3"));
  RobotDescription apart = testing_support::delta_description("delta3");
  for (LimbGeometry<double>& limb : apart.limbs) limb.p_WD *= 20;  // no strut closes
  const auto impossible = make_robot(apart);
  try {
    (void)drive_inertia(*impossible, testing_support::delta_truth(*robot));
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("is a pose of this robot"));
  }
}

}  // namespace
}  // namespace deltadyn
