#include "deltadyn/identification/torque_uncertainty.hpp"

#include <gtest/gtest.h>

#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

/// The axis: force = m a + viscous v + Coulomb sign(v).
struct Axis {
  std::unique_ptr<Robot> robot =
      make_robot(read_robot_file(std::string(DELTADYN_SOURCE_DIR) + "/data/robots/emps.urdf"));
  BaseParameters base = find_base_parameters(*robot);
  Eigen::VectorXd p = Eigen::VectorXd::Zero(robot->parameters());

  [[nodiscard]] Eigen::Index index(const std::string& name) const {
    const auto& names = robot->parameter_names();
    return static_cast<Eigen::Index>(std::find(names.begin(), names.end(), name) - names.begin());
  }
};

TEST(TorqueUncertainty, CarriesTheVarianceOfEachBaseParameter) {
  Axis axis;
  ASSERT_EQ(axis.base.count(), 3);  // mass, viscous and Coulomb friction, in this order
  axis.p(axis.index("upper_arm.m")) = 100;
  const Eigen::MatrixXd q = Eigen::MatrixXd::Zero(2, 1), qd = Eigen::Vector2d(0.5, 0.5), qdd = Eigen::Vector2d(2, -2);
  const Eigen::MatrixXd covariance = Eigen::Vector3d(0.01, 0.04, 0.09).asDiagonal();
  const TorqueUncertainty found = torque_uncertainty(*axis.robot, axis.base, covariance, axis.p, q, qd, qdd);
  EXPECT_EQ(found.states, 2);
  EXPECT_NEAR(found.std(0), std::sqrt(4 * 0.01 + 0.25 * 0.04 + 0.09), 1e-12);
  EXPECT_NEAR(found.rms_torque(0), 200, 1e-9);
  EXPECT_NEAR(found.worst_relative(), found.std(0) / 200, 1e-12);
}

TEST(TorqueUncertainty, ParameterEffectIsItsShareOfTheTorque) {
  Axis axis;
  axis.p(axis.index("upper_arm.m")) = 100;
  EXPECT_NEAR(parameter_effect(*axis.robot, axis.p)(axis.index("upper_arm.m")), 1, 1e-12);
  axis.p(axis.index("drive1.coulomb")) = 1e-3;
  const Eigen::VectorXd effect = parameter_effect(*axis.robot, axis.p);
  EXPECT_LT(effect(axis.index("drive1.coulomb")), 1e-4);
  EXPECT_GT(effect(axis.index("drive1.coulomb")), 0);
  EXPECT_EQ(effect(axis.index("upper_arm.Ixx")), 0);
}

TEST(TorqueUncertainty, TakesTheRowsOfTheLogsEvenly) {
  Axis axis;
  axis.p(axis.index("upper_arm.m")) = 1;
  Validation validation;
  validation.logs.resize(2);
  for (ValidatedLog& log : validation.logs) {
    Prediction& p = log.prediction;
    for (Eigen::MatrixXd* m : {&p.tau, &p.model, &p.q, &p.qd}) *m = Eigen::MatrixXd::Constant(500, 1, 0.1);
    p.qdd = Eigen::MatrixXd::Constant(500, 1, &log == &validation.logs[0] ? 1.0 : 3.0);
  }
  const Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(3, 3);
  const TorqueUncertainty few = torque_uncertainty_on_logs(*axis.robot, axis.base, covariance, axis.p, validation, 100);
  EXPECT_EQ(few.states, 100);
  EXPECT_NEAR(few.rms_torque(0), std::sqrt(5.0), 1e-9);  // half of 1, half of 9
  EXPECT_EQ(torque_uncertainty_on_logs(*axis.robot, axis.base, covariance, axis.p, validation, 5000).states, 1000);
}

TEST(TorqueUncertainty, RefusesWhatDoesNotFit) {
  Axis axis;
  const Eigen::MatrixXd one = Eigen::MatrixXd::Zero(1, 1), covariance = Eigen::MatrixXd::Identity(3, 3);
  EXPECT_THROW((void)torque_uncertainty(*axis.robot, axis.base, Eigen::MatrixXd::Identity(2, 2), axis.p, one, one, one),
               Error);
  EXPECT_THROW(
      (void)torque_uncertainty(*axis.robot, axis.base, covariance, axis.p, one, one, Eigen::MatrixXd::Zero(2, 1)),
      Error);
  const Eigen::MatrixXd none(0, 1);
  EXPECT_THROW((void)torque_uncertainty(*axis.robot, axis.base, covariance, axis.p, none, none, none), Error);
}

}  // namespace
}  // namespace deltadyn
