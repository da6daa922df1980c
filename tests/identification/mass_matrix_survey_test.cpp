#include "deltadyn/identification/mass_matrix_survey.hpp"

#include <Eigen/LU>
#include <cmath>
#include <gtest/gtest.h>

#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"

namespace deltadyn {
namespace {

std::unique_ptr<Robot> robot_of(const std::string& name) {
  return make_robot(read_robot_file(std::string(DELTADYN_SOURCE_DIR) + "/data/robots/" + name + ".urdf"));
}

Eigen::VectorXd nominal(const Robot& robot) {
  return nominal_parameters(robot, PartShapes(robot.description())).value;
}

Eigen::Index index_of(const Robot& robot, const std::string& name) {
  const auto& names = robot.parameter_names();
  return static_cast<Eigen::Index>(std::find(names.begin(), names.end(), name) - names.begin());
}

TEST(MassMatrixSurvey, ConsistentParametersArePositiveDefinite) {
  for (const char* name : {"delta3", "linear_delta3", "mujoco_delta4"}) {
    const auto robot = robot_of(name);
    const MassMatrixSurvey survey = survey_mass_matrix(*robot, nominal(*robot), 300, 2, 100);
    EXPECT_TRUE(survey.positive_definite()) << name;
    EXPECT_EQ(survey.states, 300);
    EXPECT_EQ(survey.eigenvalues.rows(), 100);
    EXPECT_EQ(survey.eigenvalues.cols(), robot->drives());
    EXPECT_GT(survey.min_eigenvalue, 0);
    EXPECT_LE(survey.min_eigenvalue, survey.eigenvalues.minCoeff());
    EXPECT_GE(survey.max_eigenvalue, survey.eigenvalues.maxCoeff());
    EXPECT_GE(survey.worst_condition,
              (survey.eigenvalues.rightCols<1>().array() / survey.eigenvalues.col(0).array()).maxCoeff());
    for (Eigen::Index i = 1; i < survey.eigenvalues.cols(); ++i)
      EXPECT_TRUE((survey.eigenvalues.col(i).array() >= survey.eigenvalues.col(i - 1).array()).all());
  }
}

TEST(MassMatrixSurvey, ThePoseOfTheMinimumHasIt) {
  const auto robot = robot_of("mujoco_delta4");
  const Eigen::VectorXd p = nominal(*robot);
  const MassMatrixSurvey survey = survey_mass_matrix(*robot, p, 200);
  Eigen::MatrixXd M(4, 4);
  ASSERT_EQ(robot->mass_matrix(survey.q_min, p, M), Status::ok);
  // Rayleigh: no direction has less inertia than the smallest eigenvalue, and M has it: det(M - lambda) = 0.
  const double lambda = survey.min_eigenvalue;
  EXPECT_NEAR((M - lambda * Eigen::MatrixXd::Identity(4, 4)).determinant(), 0, 1e-9 * M.trace());
  Eigen::VectorXd q(4);
  ASSERT_EQ(robot->inverse_kinematics(survey.z_min, q), Status::ok);
  EXPECT_LT((q - survey.q_min).norm(), 1e-9);
}

TEST(MassMatrixSurvey, AnAxisHasItsInertia) {
  const auto robot = robot_of("emps");
  Eigen::VectorXd p = Eigen::VectorXd::Zero(robot->parameters());
  p(index_of(*robot, "upper_arm.m")) = 95;
  const MassMatrixSurvey survey = survey_mass_matrix(*robot, p, 5);
  EXPECT_DOUBLE_EQ(survey.min_eigenvalue, 95);
  EXPECT_DOUBLE_EQ(survey.max_eigenvalue, 95);
  EXPECT_DOUBLE_EQ(survey.worst_condition, 1);
}

TEST(MassMatrixSurvey, FindsPosesWithoutInertia) {
  const auto robot = robot_of("delta3");
  Eigen::VectorXd p = nominal(*robot);
  p(index_of(*robot, "upper_arm.Iyy")) -= 1.0;
  const MassMatrixSurvey survey = survey_mass_matrix(*robot, p, 50);
  EXPECT_FALSE(survey.positive_definite());
  EXPECT_EQ(survey.not_positive, 50);
  EXPECT_LT(survey.min_eigenvalue, 0);
  EXPECT_TRUE(std::isinf(survey.worst_condition));
}

TEST(MassMatrixSurvey, SameSeedSameResult) {
  const auto robot = robot_of("delta3");
  const Eigen::VectorXd p = nominal(*robot);
  const MassMatrixSurvey a = survey_mass_matrix(*robot, p, 40, 7), b = survey_mass_matrix(*robot, p, 40, 7),
                         c = survey_mass_matrix(*robot, p, 40, 8);
  EXPECT_EQ(a.eigenvalues, b.eigenvalues);
  EXPECT_NE(a.eigenvalues, c.eigenvalues);
}

TEST(MassMatrixSurvey, RefusesWhatDoesNotFit) {
  const auto robot = robot_of("delta3");
  EXPECT_THROW((void)survey_mass_matrix(*robot, nominal(*robot), 0), Error);
  EXPECT_THROW((void)survey_mass_matrix(*robot, nominal(*robot), 10, 1, 0), Error);
  EXPECT_THROW((void)survey_mass_matrix(*robot, Eigen::VectorXd::Ones(3), 10), Error);
}

}  // namespace
}  // namespace deltadyn
