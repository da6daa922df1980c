#include "deltadyn/runtime/path_pose.hpp"

#include <gtest/gtest.h>
#include <memory>
#include <string>

#include "deltadyn/runtime/effect_states.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/runtime/workspace.hpp"

#include "identification/synthetic_log.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

class PathOf : public ::testing::TestWithParam<std::string> {};

// What a row gives does not depend on whether the row before is known.
TEST_P(PathOf, EveryRowIsWhatItIsAlone) {
  const auto robot = make_robot(testing_support::description_of(GetParam()));
  const auto states = make_effect_states(robot->description());
  const Eigen::VectorXd p = testing_support::delta_truth(*robot);
  testing_support::SyntheticOptions options;
  options.duration_s = 2;
  options.base_frequency_hz = 0.6;
  const Log log = testing_support::synthetic_log(*robot, p, options);
  const int n = robot->drives(), columns = robot->parameters();
  Eigen::MatrixXd Y(n, columns), Y_path(n, columns), M(n, n), M_path(n, n);
  Eigen::VectorXd tau(n), rates(robot->friction_joints()), rates_path = rates, z(n), z_path(n);
  PathPose path;
  EffectState state, state_path;
  for (Eigen::Index k = 0; k < log.samples(); k += 3) {
    const Eigen::VectorXd q = log.q.row(k), qd = log.qd.row(k), qdd = log.qdd.row(k);
    ASSERT_EQ(robot->regressor(q, qd, qdd, Y), Status::ok);
    ASSERT_EQ(robot->regressor(q, qd, qdd, Y_path, &path), Status::ok);
    ASSERT_LT((Y - Y_path).cwiseAbs().maxCoeff(), 1e-8 * Y.cwiseAbs().maxCoeff()) << "row " << k;
    ASSERT_EQ(robot->inverse_dynamics(q, qd, qdd, p, tau, &path), Status::ok);
    ASSERT_LT((Y * p - tau).cwiseAbs().maxCoeff(), 1e-8 * tau.cwiseAbs().maxCoeff()) << "row " << k;
    ASSERT_EQ(robot->mass_matrix(q, p, M), Status::ok);
    ASSERT_EQ(robot->mass_matrix(q, p, M_path, &path), Status::ok);
    ASSERT_LT((M - M_path).norm(), 1e-8 * M.norm());
    ASSERT_EQ(robot->friction_joint_rates(q, qd, rates), Status::ok);
    ASSERT_EQ(robot->friction_joint_rates(q, qd, rates_path, &path), Status::ok);
    ASSERT_LT((rates - rates_path).norm(), 1e-8);
    ASSERT_EQ(robot->forward_kinematics(q, z), Status::ok);
    ASSERT_EQ(robot->forward_kinematics(q, z_path, &path), Status::ok);
    ASSERT_LT((z - z_path).norm(), 1e-9);
    ASSERT_EQ(states->at(q, qd, qdd, state), Status::ok);
    ASSERT_EQ(states->at(q, qd, qdd, state_path, &path), Status::ok);
    ASSERT_LT((state.acceleration - state_path.acceleration).norm(), 1e-6);
  }
  EXPECT_EQ(path.known, robot->description().plate.has_value());
}

INSTANTIATE_TEST_SUITE_P(Types, PathOf, ::testing::Values("delta3", "linear-delta3", "delta4", "h4", "i4", "par4"),
                         [](const auto& one) {
                           std::string name = one.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST(PathPose, ForgetsAPoseThatCannotBe) {
  const auto robot = make_robot(testing_support::four_limb_description("par4"));
  Eigen::VectorXd home(4), z(4);
  WorkspaceSampler(*robot).next(home);
  PathPose path;
  ASSERT_EQ(robot->forward_kinematics(home, z, &path), Status::ok);
  EXPECT_TRUE(path.known);
  const Eigen::VectorXd torn = home + 3.0 * Eigen::Vector4d(1, -1, 1, -1);
  EXPECT_NE(robot->forward_kinematics(torn, z, &path), Status::ok);
  EXPECT_FALSE(path.known);
  EXPECT_EQ(robot->forward_kinematics(home, z, &path), Status::ok);
}

// Near the rim two poses belong to the same drives, and drives alone do not tell which; whoever came there knows.
TEST(PathPose, TellsTwoPosesOfTheSameDrivesApart) {
  RobotDescription robot = testing_support::four_limb_description("par4");
  PlateShape shape = *robot.plate;
  shape.spacing = 0.127;
  shape.bar_spacing = 0.06;
  shape.tool = ToolPlace::centre;
  robot.set_plate(shape);
  for (LimbGeometry<double>& limb : robot.limbs) {
    const Eigen::Vector3d radial(std::cos(limb.azimuth), std::sin(limb.azimuth), 0);
    limb.p_WD = 0.15 * radial;
    limb.p_DE_0 = Eigen::Vector3d(0.2, 0, 0);
    limb.strut = 0.51;
    limb.p_BA = 0.09 * radial - robot.parts[static_cast<std::size_t>(limb.part)].a;
  }
  const auto par4 = make_robot(robot);
  const Eigen::Vector4d middle(0, 0, -0.4, 0), rim(0.223, 0.077, -0.272, -3.332);
  Eigen::VectorXd q(4), z(4);
  PathPose path;
  constexpr int kSteps = 200;
  for (int k = 0; k <= kSteps; ++k) {
    const Eigen::VectorXd truth = middle + (rim - middle) * k / kSteps;
    ASSERT_EQ(par4->inverse_kinematics(truth, q), Status::ok) << k;
    ASSERT_EQ(par4->forward_kinematics(q, z, &path), Status::ok) << k;
    ASSERT_LT((z - truth).norm(), 1e-9) << k;
  }
  EXPECT_EQ(par4->forward_kinematics(q, z), Status::ambiguous);
}

}  // namespace
}  // namespace deltadyn
