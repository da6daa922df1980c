#include "deltadyn/runtime/parameter_id.hpp"

#include <gtest/gtest.h>

#include "deltadyn/runtime/robot.hpp"

#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

TEST(ParameterId, NameAndIdGoBackAndForth) {
  for (const char* type : {"delta3", "linear-delta3", "delta4", "h4", "par4"}) {
    for (const bool own : {false, true}) {
      ParameterOptions options;
      options.individual_limbs = own;
      options.offset = true;
      options.rotor_inertia = {2};
      const auto robot = make_robot(testing_support::description_of(type), options);
      ASSERT_EQ(robot->parameter_ids().size(), robot->parameter_names().size());
      for (std::size_t k = 0; k < robot->parameter_ids().size(); ++k) {
        EXPECT_EQ(parameter_id(robot->parameter_names()[k]), robot->parameter_ids()[k]) << robot->parameter_names()[k];
      }
    }
  }
}

TEST(ParameterId, SaysWhatAColumnIs) {
  EXPECT_EQ(parameter_id("strut2.Iyy"), (ParameterId{ParameterKind::inertial, 2, Body::strut, 5}));
  EXPECT_EQ(parameter_id("telescope.coulomb"), (ParameterId{ParameterKind::coulomb, 0}));
  EXPECT_EQ(parameter_id("plate.viscous"),
            (ParameterId{.kind = ParameterKind::viscous, .number = 0, .inner = InnerJointKind::plate}));
  EXPECT_EQ(parameter_id("half_plate2.m"), (ParameterId{ParameterKind::inertial, 2, Body::half_plate, 0}));
  EXPECT_EQ(parameter_id("drive12.offset"), (ParameterId{ParameterKind::offset, 12}));
  EXPECT_TRUE(parameter_id("strut2.Iyy")->same_owner(*parameter_id("strut2.m")));
  EXPECT_FALSE(parameter_id("strut2.Iyy")->same_owner(*parameter_id("strut.m")));
  EXPECT_FALSE(parameter_id("upper_arm2.Iyy")->same_owner(*parameter_id("drive2.viscous")));
}

TEST(ParameterId, OfNamesThatNoRobotHasIsNothing) {
  for (const char* name : {"", ".", "m", "elbow.m", "drive1.stiffness", "friction", "drive.viscous",
                           "telescope1.viscous", "strut02.m", "strut99999999999.m", "strut.m.m", "2.m"}) {
    EXPECT_FALSE(parameter_id(name)) << name;
  }
}

}  // namespace
}  // namespace deltadyn
