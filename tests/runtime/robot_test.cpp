#include "deltadyn/runtime/robot.hpp"

#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "deltadyn/dynamics/inverse_dynamics.hpp"
#include "deltadyn/dynamics/mass_matrix.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/geometry_of.hpp"

#include "support/descriptions.hpp"
#include "support/matchers.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;
using ::testing::Contains;
using ::testing::ElementsAre;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

ParameterOptions all_columns(int drives) {
  ParameterOptions options;
  options.individual_limbs = options.offset = true;
  for (int drive = 1; drive <= drives; ++drive) options.rotor_inertia.push_back(drive);
  return options;
}

TEST(Robot, ForwardsToTheFixedSizeCore) {
  using Layout = ParameterLayout<Delta4, Limbs::individual>;
  const RobotDescription description = delta_description("delta4");
  const auto robot = make_robot(description, all_columns(4));
  const auto geometry = geometry_of<double, Delta4>(description);
  ASSERT_EQ(robot->parameters(), Layout::kColumns);
  Random random(8);
  const auto p = random_parameters<Layout>(random);
  const auto task = random_task<Delta4>(random);
  Motion<double, Delta4> motion;
  ASSERT_EQ(motion_from_task(geometry, task.z, task.zd, task.zdd, motion), Status::ok);

  Eigen::VectorXd q(4), qd(4), qdd(4), z(4), tau(4), rates(5);
  Eigen::MatrixXd J(4, 4), M(4, 4), Y(4, robot->parameters());
  TaskState state{task.z, task.zd, task.zdd}, back;
  ASSERT_EQ(robot->to_drives(state, q, qd, qdd), Status::ok);
  EXPECT_EQ(q, motion.posture.q);
  EXPECT_EQ(qd, motion.qd);
  EXPECT_EQ(qdd, motion.qdd);
  ASSERT_EQ(robot->to_task(q, qd, qdd, back), Status::ok);
  EXPECT_THAT(back.z, IsNear(task.z, 1e-12));
  EXPECT_THAT(back.zd, IsNear(task.zd, 1e-11));
  EXPECT_THAT(back.zdd, IsNear(task.zdd, 1e-10));
  ASSERT_EQ(robot->inverse_kinematics(task.z, z), Status::ok);
  EXPECT_EQ(z, q);
  ASSERT_EQ(robot->forward_kinematics(q, z), Status::ok);
  EXPECT_THAT(z, IsNear(task.z, 1e-12));
  ASSERT_EQ(robot->jacobian(q, J), Status::ok);
  EXPECT_THAT((J * qd).eval(), IsNear(task.zd, 1e-10));
  ASSERT_EQ(robot->inverse_dynamics(q, qd, qdd, p, tau), Status::ok);
  EXPECT_THAT(tau, IsNear(inverse_dynamics<Layout>(geometry, motion, p), 1e-9));
  ASSERT_EQ(robot->regressor(q, qd, qdd, Y), Status::ok);
  EXPECT_THAT((Y * p).eval(), IsNear(tau, 1e-9));
  ASSERT_EQ(robot->mass_matrix(q, p, M), Status::ok);
  EXPECT_THAT(M, IsNear(mass_matrix<Layout>(geometry, motion.posture, p), 1e-10));
  Eigen::VectorXd qdd_again(4);
  ASSERT_EQ(robot->forward_dynamics(q, qd, tau, p, qdd_again), Status::ok);
  EXPECT_THAT(qdd_again, IsNear(qdd, 1e-9 * qdd.norm()));
  ASSERT_EQ(robot->friction_joint_rates(q, qd, rates), Status::ok);
  EXPECT_THAT(rates.head(4).eval(), IsNear(qd, 0));
  EXPECT_NEAR(rates(4), motion.telescope.length_d, 1e-10);
  EXPECT_EQ(robot->friction_joints(), 5);
}

TEST(Robot, GivesTheTermsOfTheEquationsOfMotion) {
  const auto robot = make_robot(delta_description("delta4"), all_columns(4));
  Random random(9);
  const Eigen::VectorXd p = random_parameters<ParameterLayout<Delta4, Limbs::individual>>(random);
  const auto task = random_task<Delta4>(random);
  Eigen::VectorXd q(4), qd(4), qdd(4), tau(4);
  ASSERT_EQ(robot->to_drives({task.z, task.zd, task.zdd}, q, qd, qdd), Status::ok);
  ASSERT_EQ(robot->inverse_dynamics(q, qd, qdd, p, tau), Status::ok);
  EquationTerms drives, plate;
  ASSERT_EQ(robot->equations_of_motion(q, qd, p, Coordinates::drives, drives), Status::ok);
  EXPECT_THAT((drives.M * qdd + drives.C * qd + drives.g + drives.f).eval(), IsNear(tau, 1e-9));
  ASSERT_EQ(robot->equations_of_motion(q, qd, p, Coordinates::task, plate), Status::ok);
  Eigen::MatrixXd J(4, 4);
  ASSERT_EQ(robot->jacobian(q, J), Status::ok);
  const Eigen::VectorXd force = plate.M * task.zdd + plate.C * task.zd + plate.g + plate.f;
  EXPECT_THAT((J.transpose() * force).eval(), IsNear(tau, 1e-9));
  Energies energies;
  ASSERT_EQ(robot->energies(q, qd, p, energies), Status::ok);
  EXPECT_NEAR(energies.kinetic, 0.5 * qd.dot(drives.M * qd), 1e-10);
  TorqueSlopes slopes;
  ASSERT_EQ(robot->inverse_dynamics_derivatives(q, qd, qdd, p, slopes), Status::ok);
  EXPECT_THAT(slopes.by_qdd, IsNear(drives.M, 1e-10));
  std::vector<JointReaction> reactions;
  ASSERT_EQ(robot->joint_reactions(q, qd, qdd, p, reactions), Status::ok);
  ASSERT_EQ(reactions.size(), 3U * 5U + 4U);
  EXPECT_EQ(reactions[1].joint, "strut1a.elbow");
  EXPECT_EQ(reactions.back().onto, "tool");
}

TEST(Robot, NamesTheJointsOfAnArticulatedPlate) {
  const auto robot = make_robot(four_limb_description("par4"));
  Eigen::VectorXd q(4), qd(4), qdd(4);
  const Eigen::Vector4d z(0.02, 0.01, -0.7, 0.3), zd(0.1, 0.2, -0.1, 1), zdd(1, -2, 1, 5);
  ASSERT_EQ(robot->to_drives({z, zd, zdd}, q, qd, qdd), Status::ok);
  std::vector<JointReaction> reactions;
  ASSERT_EQ(robot->joint_reactions(q, qd, qdd, Eigen::VectorXd::Ones(robot->parameters()), reactions), Status::ok);
  ASSERT_EQ(reactions.size(), 4U * 5U + 2U);
  EXPECT_EQ(reactions[2].joint, "strut1a.plate");
  EXPECT_EQ(reactions[2].onto, "half_plate1");
  EXPECT_EQ(reactions.back().joint, "half_plate2.joints");
  EXPECT_EQ(reactions.back().onto, "half_plate2");
}

TEST(Robot, NamesItsColumnsInTheOrderOfTheRegressor) {
  const auto axis = make_robot(axis_description(DriveKind::revolute));
  EXPECT_THAT(axis->parameter_names(),
              ElementsAre("upper_arm.m", "upper_arm.mcx", "upper_arm.mcy", "upper_arm.mcz", "upper_arm.Ixx",
                          "upper_arm.Iyy", "upper_arm.Izz", "upper_arm.Ixy", "upper_arm.Iyz", "upper_arm.Ixz",
                          "drive1.viscous", "drive1.coulomb"));
  EXPECT_EQ(axis->parameter_units().back(), "N*m");
  const auto linear = make_robot(axis_description(DriveKind::prismatic), all_columns(1));
  EXPECT_EQ(linear->parameter_units().back(), "N");
  EXPECT_EQ(linear->parameter_names().back(), "drive1.offset");
  EXPECT_THAT(make_robot(delta_description("delta4"), all_columns(4))->parameter_names(), Contains("strut3.Ixx"));
}

// Columns that are left out must be gone by name and by content, and nothing else may move.
TEST(Robot, LeavesOutColumnsByName) {
  const auto full = make_robot(delta_description("delta4"), {false, true, {1, 2, 3, 4}, true});
  Random random(6);
  const auto task = random_task<Delta4>(random);
  Eigen::VectorXd q(4), qd(4), qdd(4);
  ASSERT_EQ(full->to_drives({task.z, task.zd, task.zdd}, q, qd, qdd), Status::ok);
  Eigen::MatrixXd Y(4, full->parameters());
  ASSERT_EQ(full->regressor(q, qd, qdd, Y), Status::ok);
  const ParameterOptions bare{false, false, {}, false}, with_offset{false, true, {}, true},
      with_rotor{false, false, {4, 2}, false};
  for (const ParameterOptions& options : {bare, with_offset, with_rotor}) {
    const auto robot = make_robot(delta_description("delta4"), options);
    Eigen::MatrixXd part(4, robot->parameters());
    ASSERT_EQ(robot->regressor(q, qd, qdd, part), Status::ok);
    for (int k = 0; k < robot->parameters(); ++k) {
      const auto& names = full->parameter_names();
      const std::string& wanted = robot->parameter_names()[static_cast<std::size_t>(k)];
      const auto at = std::find(names.begin(), names.end(), wanted) - names.begin();
      ASSERT_LT(at, full->parameters());
      EXPECT_EQ(part.col(k), Y.col(at)) << wanted;
    }
    EXPECT_EQ(std::count(robot->parameter_names().begin(), robot->parameter_names().end(), "tool.m"),
              options.tool ? 1 : 0);
    const int rotors = static_cast<int>(options.rotor_inertia.size());
    EXPECT_EQ(robot->parameters(), 60 + 10 * options.tool + rotors + 4 * options.offset);
  }
}

TEST(Robot, LeavesTheOutputAloneOnFailure) {
  const auto robot = make_robot(delta_description("delta3"));
  Eigen::VectorXd out = Eigen::VectorXd::Constant(3, 42), bad = Eigen::VectorXd::Zero(3);
  bad(1) = kMissing;
  EXPECT_EQ(robot->inverse_kinematics(bad, out), Status::out_of_range);
  EXPECT_EQ(robot->inverse_kinematics(Eigen::Vector3d(9, 9, 9), out), Status::unreachable);
  EXPECT_EQ(robot->forward_kinematics(bad, out), Status::out_of_range);
  const Eigen::VectorXd p = Eigen::VectorXd::Ones(robot->parameters());
  EXPECT_EQ(robot->inverse_dynamics(bad, bad, bad, p, out), Status::out_of_range);
  EXPECT_EQ(robot->forward_dynamics(bad, bad, bad, p, out), Status::out_of_range);
  EXPECT_EQ(out, Eigen::VectorXd::Constant(3, 42));
}

TEST(MakeRobot, RefusesTypesThatItDoesNotKnow) {
  RobotDescription robot = delta_description("delta3");
  robot.type = "hexapod";
  EXPECT_THROW((void)make_robot(robot), Error);
}

}  // namespace
}  // namespace deltadyn
