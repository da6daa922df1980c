#include "deltadyn/runtime/plausibility.hpp"

#include <cmath>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "deltadyn/runtime/nominal_parameters.hpp"

#include "support/description_faults.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing_support::axis_description;
using testing_support::delta_description;
using testing_support::DescriptionFault;
using testing_support::expect_refused;
using testing_support::Lengths;

constexpr double kDegree = 3.14159265358979323846 / 180;

/// What a robot of a manufacturer's catalogue has, scaled: arm, strut, radii.
RobotDescription robot_of_size(const std::string& type, double size) {
  Lengths lengths;
  lengths.base_radius *= size;
  lengths.platform_radius *= size;
  lengths.upper_arm *= size;
  lengths.strut *= size;
  lengths.strut_spacing *= size;
  return delta_description(type, lengths);
}

void set_limits(RobotDescription& robot, double lower, double upper, double velocity, double acceleration,
                double unit = 1) {
  for (DriveLimits& limits : robot.limits) {
    limits.lower = lower * unit;
    limits.upper = upper * unit;
    limits.velocity = velocity * unit;
    limits.acceleration = acceleration * unit;
  }
}

TEST(Plausibility, RobotsFromFiveCentimetresToTwoMetresOfArmPass) {
  for (const char* type : {"delta3", "linear-delta3", "delta4"})
    for (const double arm : {0.05, 0.1, 0.3, 0.525, 1.0, 2.0}) {
      SCOPED_TRACE(std::string(type) + " with an arm of " + std::to_string(arm));
      RobotDescription robot = robot_of_size(type, arm / 0.525);
      // The smaller, the faster: the same acceleration at the plate.
      set_limits(robot, -0.9, 1.6, 5 / std::sqrt(arm), 50 / arm);
      if (robot.drive_kind == DriveKind::prismatic) set_limits(robot, 0, 2 * arm, 4, 40);
      EXPECT_NO_THROW(robot.validate("robot.urdf"));
      const auto made = make_robot(robot);
      EXPECT_NO_THROW((void)nominal_parameters(*made, PartShapes(robot)));
    }
}

TEST(Plausibility, AHeavyPlateOnALargeRobotPasses) {
  const auto robot = make_robot(robot_of_size("delta3", 2.0 / 0.525));
  PartShapes shapes(robot->description());
  shapes.platform_mass = 30;
  EXPECT_NO_THROW((void)nominal_parameters(*robot, shapes));
}

TEST(Plausibility, ATestBenchMayTurnFast) {
  RobotDescription axis = axis_description(DriveKind::revolute);
  set_limits(axis, -100, 100, 600, 1e4);
  EXPECT_NO_THROW(axis.validate("axis.urdf"));
}

void in_millimetres(LimbGeometry<double>& limb) {
  limb.p_WD *= 1000;
  limb.p_DE_0 *= 1000;
  limb.p_BA *= 1000;
  limb.strut *= 1000;
  limb.strut_spacing *= 1000;
}

const DescriptionFault kImplausible[] = {
    {"AllInMillimetres", "delta4",
     [](auto& r) {
       for (auto& limb : r.limbs) in_millimetres(limb);
     },
     "looks like millimetres"},
    {"AllInCentimetres", "delta4", [](auto& r) { r = robot_of_size("delta4", 100); }, "limb 1"},
    {"OneLimbInMillimetres", "delta3", [](auto& r) { in_millimetres(r.limbs[1]); }, "limb 2"},
    {"OneOriginInMillimetres", "delta3", [](auto& r) { r.limbs[2].p_WD *= 1000; }, "limb 3"},
    {"SmallRobotOneOriginInMillimetres", "delta3",
     [](auto& r) {
       r = robot_of_size("delta3", 0.04 / 0.525);
       r.limbs[0].p_BA *= 1000;
     },
     "the attachment from the plate's centre"},
    {"StrutInCentimetres", "delta3",
     [](auto& r) {
       r = robot_of_size("delta3", 0.05 / 0.525);
       for (auto& limb : r.limbs) limb.strut *= 100;
     },
     ""},
    {"OneStrutInCentimetres", "delta3",
     [](auto& r) {
       r = robot_of_size("delta3", 0.03 / 0.525);
       r.limbs[1].strut *= 100;
     },
     "another unit"},
    {"SpacingInMillimetres", "linear-delta3", [](auto& r) { r.limbs[1].strut_spacing = 100; }, "the two struts"},
    {"SpacingInCentimetres", "linear-delta3",
     [](auto& r) {
       for (auto& limb : r.limbs) limb.strut_spacing = 10;
     },
     "the two struts"},
    {"TelescopeInMillimetres", "delta4", [](auto& r) { r.telescope->p_WU.z() = 50; }, "telescope"},
    {"GravityInMillimetres", "delta3", [](auto& r) { r.gravity *= 1000; }, "gravity"},
    {"GravityATenth", "delta3", [](auto& r) { r.gravity *= 0.1; }, "gravity"},
    {"NoGravity", "delta3", [](auto& r) { r.gravity.setZero(); }, "gravity"},
    {"RangeInDegrees", "delta3", [](auto& r) { set_limits(r, -50, 90, 10, 100); }, "looks like degrees"},
    {"NarrowRangeInDegrees", "delta3", [](auto& r) { set_limits(r, -5, 5, 10, 100); }, "width of the position range"},
    {"VelocityInDegrees", "delta3", [](auto& r) { set_limits(r, -0.9, 1.6, 500, 100); }, "looks like degrees"},
    {"SlowVelocityInDegrees", "delta3", [](auto& r) { set_limits(r, -0.9, 1.6, 90, 100); }, "looks like degrees"},
    {"AccelerationInDegrees", "delta3", [](auto& r) { set_limits(r, -0.9, 1.6, 10, 5000); }, "looks like degrees"},
    {"YawInDegrees", "delta4", [](auto& r) { r.limits[3].lower = -180, r.limits[3].upper = 180; }, "drive 4"},
    {"YawVelocityInDegrees", "delta4", [](auto& r) { r.limits[3].velocity = 2760; }, "looks like degrees"},
    {"RailInMillimetres", "linear-delta3", [](auto& r) { r.limits[0].lower = 0, r.limits[0].upper = 900; },
     "looks like millimetres"},
    {"RailVelocityInMillimetres", "linear-delta3", [](auto& r) { r.limits[2].velocity = 4000; }, "drive 3"},
    {"RailAccelerationInMillimetres", "linear-delta3", [](auto& r) { r.limits[2].acceleration = 40000; }, "drive 3"},
    {"TorqueInNewtonMillimetres", "delta3", [](auto& r) { r.limits[1].effort = 60000; }, "N mm"},
    {"EndlessInDegrees", "delta3", [](auto& r) { r.limits[1].lower = -360, r.limits[1].upper = 360; }, "drive 2"},
};

class ImplausibleRobot : public ::testing::TestWithParam<DescriptionFault> {};

TEST_P(ImplausibleRobot, IsRefusedWithTheUnitAndTheMend) {
  expect_refused(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Table, ImplausibleRobot, ::testing::ValuesIn(kImplausible),
                         [](const auto& entry) { return std::string(entry.param.name); });

TEST(Plausibility, TheUnitThatWouldFitIsNamed) {
  try {
    plausibility::require(plausibility::kLength, 525, "--upper-arm", "", ExitCode::usage);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.problem(), AllOf(HasSubstr("--upper-arm is 525 m"), HasSubstr("looks like millimetres")));
    EXPECT_THAT(error.mend(), HasSubstr("525 millimetres are 0.525 m"));
    EXPECT_EQ(error.code(), ExitCode::usage);
  }
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), -1.0, 0.0})
    EXPECT_THROW(plausibility::require(plausibility::kLength, bad, "a length", ""), Error) << bad;
}

TEST(Plausibility, WhatIsHardlyTooLargeIsInNoOtherUnit) {
  for (const auto& [tilt, words] : {std::pair(1.57, false), std::pair(-1.57, false), std::pair(30.0, true)}) {
    try {
      plausibility::require(plausibility::kLimbTilt, tilt, "the tilt", "a.urdf");
      ADD_FAILURE() << tilt;
    } catch (const Error& error) {
      EXPECT_EQ(error.problem().find("looks like degrees") != std::string::npos, words) << error.problem();
    }
  }
}

/// Every mass in grams is seen, for robots of every size; the same masses in kilograms pass.
TEST(Plausibility, GramsAreSeenAtEverySize) {
  for (const char* type : {"delta3", "linear-delta3", "delta4"})
    for (const double arm : {0.1, 0.3, 0.525, 1.0}) {
      const RobotDescription description = robot_of_size(type, arm / 0.525);
      const auto robot = make_robot(description);
      const NominalParameters nominal = nominal_parameters(*robot, PartShapes(description));
      for (int k = 0; k < robot->parameters(); ++k) {
        const std::string& name = robot->parameter_names()[static_cast<std::size_t>(k)];
        if (name.size() < 2 || name.substr(name.size() - 2) != ".m") continue;
        const std::string what = name.substr(0, name.size() - 2);
        for (const Body body : {Body::upper_arm, Body::strut, Body::platform, Body::tool, Body::telescope_upper}) {
          if (what != deltadyn::name(body)) continue;
          const InertialVector<double> p = nominal.value.segment<kInertialParameters>(k);
          EXPECT_NO_THROW(plausibility::require_body(description, body, p, what, "p.csv"))
              << type << " " << arm << " " << what;
          EXPECT_THROW(plausibility::require_body(description, body, 1000 * p, what, "p.csv"), Error)
              << type << " " << arm << " " << what << " of " << p(0) << " kg in grams";
          InertialVector<double> moments = p;
          moments.tail<6>() *= 1e6;
          EXPECT_THROW(plausibility::require_body(description, body, moments, what, "p.csv"), Error)
              << type << " " << arm << " " << what << " in kg mm^2";
          EXPECT_THROW(plausibility::require_body(description, body, -p, what, "p.csv"), Error);
        }
      }
    }
}

TEST(Plausibility, LimitsBeyondTheRobotFileAreToldOrRefused) {
  RobotDescription robot = delta_description("delta3");
  set_limits(robot, -0.9, 1.6, 10, 100);
  DriveLimits asked = robot.limits[0];
  EXPECT_EQ(plausibility::compare_limits(robot, 0, asked, ""), "");
  asked.velocity = 8;
  EXPECT_EQ(plausibility::compare_limits(robot, 0, asked, ""), "");
  asked.velocity = 12;
  EXPECT_THAT(plausibility::compare_limits(robot, 0, asked, ""),
              AllOf(HasSubstr("drive 1"), HasSubstr("12 rad/s"), HasSubstr("10 rad/s")));
  asked.velocity = 500 * kDegree * 2;
  EXPECT_THROW((void)plausibility::compare_limits(robot, 0, asked, ""), Error);
  asked = robot.limits[0];
  asked.lower = -1.0;
  EXPECT_THAT(plausibility::compare_limits(robot, 0, asked, ""), HasSubstr("lower position"));
  asked.lower = -3;
  EXPECT_THROW((void)plausibility::compare_limits(robot, 0, asked, ""), Error);
}

TEST(Plausibility, JointParameters) {
  EXPECT_NO_THROW(plausibility::require_joint_parameter(ParameterKind::viscous, 200, "drive1.viscous", ""));
  EXPECT_THROW(plausibility::require_joint_parameter(ParameterKind::viscous, -0.1, "drive1.viscous", ""), Error);
  EXPECT_THROW(plausibility::require_joint_parameter(ParameterKind::coulomb, -4, "drive1.coulomb", ""), Error);
  EXPECT_THROW(plausibility::require_joint_parameter(ParameterKind::coulomb, std::nan(""), "drive1.coulomb", ""),
               Error);
  EXPECT_NO_THROW(plausibility::require_joint_parameter(ParameterKind::offset, -3, "drive1.offset", ""));
}

}  // namespace
}  // namespace deltadyn
