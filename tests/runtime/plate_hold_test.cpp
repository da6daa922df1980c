#include "deltadyn/runtime/plate_hold.hpp"

#include <gtest/gtest.h>

#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/runtime/workspace.hpp"

#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

double margin_at(const RobotDescription& description, double x, double y) {
  const auto robot = make_robot(description);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(robot->drives()), q = z;
  z.head<3>() = WorkspaceSampler(*robot).ball().centre + Eigen::Vector3d(x, y, 0);
  EXPECT_EQ(robot->inverse_kinematics(z, q), Status::ok);
  return tipping_margin(*robot, q);
}

TEST(TippingMargin, AnH4InTheDiagonalsTipsAboutItsCrossbar) {
  const RobotDescription robot = four_limb_description("h4");
  EXPECT_LT(margin_at(robot, 0, 0), 1e-9);
  EXPECT_LT(margin_at(robot, 0, 0.1), 1e-9);
  EXPECT_GT(margin_at(robot, 0.1, 0.05), 1e-2);
}

TEST(TippingMargin, LimbsInThreeDirectionsHoldAnH4) {
  RobotDescription robot = four_limb_description("h4");
  PlateShape shape = *robot.plate;
  shape.azimuth = 0;
  robot.set_plate(shape);
  const double azimuth[] = {0, -1.5707963267948966, 3.141592653589793, -1.5707963267948966};
  for (std::size_t i = 0; i < 4; ++i) {
    auto& limb = robot.limbs[i];
    limb.azimuth = azimuth[i];
    const Eigen::Vector3d radial(std::cos(azimuth[i]), std::sin(azimuth[i]), 0);
    const double side = i % 2 == 1 ? (i == 1 ? 0.06 : -0.06) : 0;
    limb.p_WD = 0.2 * radial + Eigen::Vector3d(side, 0, 0);
    limb.p_BA = Eigen::Vector3d(i % 2 == 0 ? 0.03 * radial.x() : 0, i % 2 == 1 ? -0.05 : 0, 0);
  }
  robot.validate("h4");
  EXPECT_GT(margin_at(robot, 0, 0), 0.3);
}

TEST(TippingMargin, BarsAndSlidesHoldTheirHalves) {
  for (const char* type : {"i4", "par4"}) EXPECT_EQ(margin_at(four_limb_description(type), 0, 0), 1) << type;
  EXPECT_EQ(margin_at(delta_description("delta3"), 0, 0), 1);
}

}  // namespace
}  // namespace deltadyn
