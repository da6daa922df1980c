#include "deltadyn/runtime/articulated_plate.hpp"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <initializer_list>
#include <numbers>
#include <vector>

#include "deltadyn/runtime/error.hpp"

#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using ::testing::HasSubstr;
using testing_support::four_limb_description;

std::vector<LimbGeometry<double>> limbs_at(std::initializer_list<double> azimuths) {
  std::vector<LimbGeometry<double>> limbs;
  for (const double azimuth : azimuths) limbs.emplace_back().azimuth = azimuth;
  return limbs;
}

TEST(WidestGap, GoesOnceRound) {
  EXPECT_NEAR(widest_gap(limbs_at({0.5, 2.0, 3.5, 5.5})), 2.0, 1e-12);
  EXPECT_NEAR(widest_gap(limbs_at({-0.2, 0.3, 6.0})), 6.0 - 0.3, 1e-12);
  EXPECT_NEAR(widest_gap(limbs_at({1.0, 1.0 + 2 * std::numbers::pi})), 2 * std::numbers::pi, 1e-9);
}

TEST(AngleBetweenLimbs, IsThatOfThoseOnOnePart) {
  std::vector<LimbGeometry<double>> limbs = limbs_at({0.2, 0.2 + std::numbers::pi, 0.9, 1.4});
  limbs[2].part = limbs[3].part = 1;
  EXPECT_LT(largest_angle_between_limbs(limbs, 0), kParallel) << "opposite limbs hold alike";
  EXPECT_NEAR(largest_angle_between_limbs(limbs, 1), std::sin(0.5), 1e-12);
}

TEST(ValidateShape, NamesTheLengthAndTheGear) {
  struct Fault {
    const char* type;
    void (*spoil)(PlateShape&);
    const char* words;
  };
  const Fault faults[] = {
      {"h4", [](PlateShape& s) { s.spacing = 0; }, "hinges of the two halves is 0 m"},
      {"h4", [](PlateShape& s) { s.bar_spacing = 0.1; }, "this type has none"},
      {"par4", [](PlateShape& s) { s.bar_spacing = -0.1; }, "two bars is -0.1 m"},
      {"i4", [](PlateShape& s) { s.pinion_radius = 0; }, "radius of the pinion is 0 m"},
      {"i4", [](PlateShape& s) { s.ratio = 2; }, "the ratio of its gear is 2"},
      {"par4", [](PlateShape& s) { s.ratio = 0; }, "the ratio of the tool's gear is 0"},
      {"par4", [](PlateShape& s) { s.range = 1.5; }, "the parts of the plate collide"},
      {"i4", [](PlateShape& s) { s.range = 0; }, "the range of theta is 0 rad"},
      {"h4", [](PlateShape& s) { s.range = 1e-9; }, "range of theta"},
  };
  for (const Fault& fault : faults) {
    RobotDescription robot = four_limb_description(fault.type);
    EXPECT_NO_THROW(articulated_plate::validate_shape(robot, "a.urdf"));
    fault.spoil(*robot.plate);
    try {
      articulated_plate::validate_shape(robot, "a.urdf, line 7");
      ADD_FAILURE() << "accepted: " << fault.words;
    } catch (const Error& error) {
      EXPECT_THAT(error.problem(), HasSubstr(fault.words));
      EXPECT_EQ(error.where(), "a.urdf, line 7");
      EXPECT_FALSE(error.mend().empty());
    }
  }
}

}  // namespace
}  // namespace deltadyn
