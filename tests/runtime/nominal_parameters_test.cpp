#include "deltadyn/runtime/nominal_parameters.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <string>

#include "deltadyn/model/inertial_parameters.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

RobotDescription delta4(double size) {
  RobotDescription robot;
  robot.type = "delta4";
  for (int i = 0; i < 3; ++i) {
    LimbGeometry<double> limb;
    limb.azimuth = 2.0943951023931953 * i;
    const Vector3<double> radial(std::cos(limb.azimuth), std::sin(limb.azimuth), 0);
    limb.p_WD = 0.2 * size * radial;
    limb.p_DE_0.x() = 0.525 * size;
    limb.strut = 1.106 * size;
    limb.p_BA = 0.05 * size * radial;
    robot.limbs.push_back(limb);
  }
  robot.parts.emplace_back();
  robot.telescope.emplace();
  robot.limits.resize(4);
  return robot;
}

double value(const Robot& robot, const NominalParameters& nominal, const std::string& name) {
  const auto& names = robot.parameter_names();
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k] == name) return nominal.value(static_cast<Eigen::Index>(k));
  ADD_FAILURE() << "no parameter " << name;
  return 0;
}

TEST(NominalParameters, ThePapersRobotGetsThePapersValues) {
  const auto robot = make_robot(delta4(1));
  const NominalParameters nominal = nominal_parameters(*robot, PartShapes(robot->description()));
  EXPECT_NEAR(value(*robot, nominal, "strut.m"), 0.249, 5e-4);
  EXPECT_NEAR(value(*robot, nominal, "platform.m"), 1.0, 1e-12);
  EXPECT_NEAR(value(*robot, nominal, "telescope_upper.mcz"), -0.315, 5e-4);
  EXPECT_NEAR(value(*robot, nominal, "telescope_upper.Ixx"), 0.147, 5e-4);
  EXPECT_NEAR(value(*robot, nominal, "telescope_upper.Izz"), 28.8e-6, 1e-12);
  EXPECT_NEAR(value(*robot, nominal, "telescope_lower.mcz"), 0.234, 5e-4);
  EXPECT_NEAR(value(*robot, nominal, "telescope_lower.Izz"), 78.0e-6, 1e-12);
}

TEST(NominalParameters, BodiesAreConsistentAndNoUncertaintyIsZero) {
  for (const double size : {0.2, 1.0, 3.0})
    for (const bool individual : {false, true}) {
      ParameterOptions options;
      options.individual_limbs = individual;
      options.rotor_inertia = {1, 2, 3, 4};
      options.offset = true;
      const auto robot = make_robot(delta4(size), options);
      const NominalParameters nominal = nominal_parameters(*robot, PartShapes(robot->description()));
      ASSERT_EQ(nominal.value.size(), robot->parameters());
      EXPECT_GT(nominal.std.minCoeff(), 0);
      int bodies = 0;
      for (int k = 0; k < robot->parameters(); ++k) {
        const std::string& name = robot->parameter_names()[static_cast<std::size_t>(k)];
        if (name.size() < 2 || name.substr(name.size() - 2) != ".m") continue;
        ++bodies;
        EXPECT_TRUE(is_physically_consistent<double>(nominal.value.segment<kInertialParameters>(k)))
            << name << " at size " << size;
      }
      EXPECT_EQ(bodies, individual ? 10 : 6);
    }
}

// Limbs with parameters of their own have them from their own lengths.
TEST(NominalParameters, EachLimbHasItsOwnLength) {
  RobotDescription uneven = delta4(1);
  EXPECT_TRUE(uneven.limbs_are_alike());
  uneven.limbs[2].strut *= 1.2;
  uneven.limbs[1].p_DE_0 *= 0.9;
  EXPECT_FALSE(uneven.limbs_are_alike());
  ParameterOptions options;
  options.individual_limbs = true;
  const auto robot = make_robot(uneven, options);
  const NominalParameters nominal = nominal_parameters(*robot, PartShapes(uneven));
  const auto of = [&](const char* name) { return value(*robot, nominal, name); };
  EXPECT_EQ(of("strut1.m"), of("strut2.m"));
  EXPECT_GT(of("strut3.m"), 1.05 * of("strut1.m"));
  EXPECT_GT(of("strut3.Iyy"), 1.3 * of("strut1.Iyy"));
  EXPECT_LT(of("upper_arm2.mcx"), 0.95 * of("upper_arm1.mcx"));
  EXPECT_EQ(of("upper_arm3.mcx"), of("upper_arm1.mcx"));
}

TEST(NominalParameters, StandardDeviationsScaleWithTheShare) {
  const auto robot = make_robot(delta4(1));
  PartShapes shapes(robot->description());
  const NominalParameters half = nominal_parameters(*robot, shapes);
  shapes.body_std *= 0.5;
  shapes.friction_std *= 0.5;
  const NominalParameters quarter = nominal_parameters(*robot, shapes);
  EXPECT_LT((half.std - 2 * quarter.std).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_EQ((half.value - quarter.value).norm(), 0);
}

TEST(NominalParameters, ImpossibleShapesAreRefused) {
  const auto robot = make_robot(delta4(1));
  const PartShapes good(robot->description());
  const auto refused = [&](double PartShapes::*member, double bad) {
    PartShapes shapes = good;
    shapes.*member = bad;
    try {
      (void)nominal_parameters(*robot, shapes);
      ADD_FAILURE() << "accepted " << bad;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::usage);
    }
  };
  refused(&PartShapes::platform_mass, 0);
  refused(&PartShapes::platform_mass, -1);
  refused(&PartShapes::tool_diameter, 0);
  refused(&PartShapes::upper_arm_wall, 0.1);
  refused(&PartShapes::upper_arm_density, 0);
  refused(&PartShapes::upper_arm_hub_mass, -1);
  refused(&PartShapes::strut_sockets_mass, std::nan(""));
  refused(&PartShapes::strut_socket_diameter, 0.001);
  refused(&PartShapes::telescope_upper_share, 1);
  refused(&PartShapes::telescope_lower_inner_diameter, 0.05);
  refused(&PartShapes::drive_viscous, 0);
  refused(&PartShapes::body_std, 0);
}

TEST(NominalParameters, EveryTypeHasThem) {
  RobotDescription axis;
  axis.type = "axis";
  axis.limbs.emplace_back();
  axis.limits.resize(1);
  for (const DriveKind kind : {DriveKind::revolute, DriveKind::prismatic}) {
    axis.drive_kind = kind;
    axis.limbs[0].axis_L = kind == DriveKind::prismatic ? Vector3<double>::UnitX() : Vector3<double>::UnitY();
    const auto robot = make_robot(axis);
    const NominalParameters nominal = nominal_parameters(*robot, PartShapes(axis));
    EXPECT_GT(value(*robot, nominal, "upper_arm.m"), 0);
    EXPECT_GT(value(*robot, nominal, "drive1.coulomb"), 0);
  }
}

}  // namespace
}  // namespace deltadyn
