#include "deltadyn/identification/prediction.hpp"

#include <gtest/gtest.h>

#include "identification/synthetic_log.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

TEST(Prediction, TrueParametersLeaveTheNoise) {
  const auto robot = make_robot(delta_description("delta4"));
  SyntheticOptions synthetic;
  synthetic.torque_noise = 0.1;
  ProcessingOptions options;
  options.filter = false;
  const PreparedLog log = prepare_log(*robot, synthetic_log(*robot, delta_truth(*robot), synthetic), options);
  const Prediction prediction = predict(*robot, log, delta_truth(*robot));
  ASSERT_EQ(prediction.rows(), log.t_s.size());
  EXPECT_NEAR(prediction.rms_residual(0, true), 0.1, 0.005);
  EXPECT_NEAR(prediction.rms_residual(3, true), 0.01, 0.0005);
  EXPECT_GT(prediction.rms_torque(0, true), 1.0);
  EXPECT_EQ(prediction.t_s, log.t_s);
  EXPECT_EQ(prediction.q, log.q);
}

TEST(Prediction, ModelIsInverseDynamicsOfTheState) {
  const auto robot = make_robot(delta_description("delta3"));
  const Eigen::VectorXd p = 0.5 * delta_truth(*robot);
  ProcessingOptions options;
  options.filter = false;
  const PreparedLog log = prepare_log(*robot, synthetic_log(*robot, delta_truth(*robot), SyntheticOptions{}), options);
  const Prediction prediction = predict(*robot, log, p);
  Eigen::VectorXd tau(3);
  for (Eigen::Index k = 0; k < prediction.rows(); k += 100) {
    ASSERT_EQ(robot->inverse_dynamics(log.q.row(k).transpose(), log.qd.row(k).transpose(), log.qdd.row(k).transpose(),
                                      p, tau),
              Status::ok);
    EXPECT_LT((prediction.model.row(k).transpose() - tau).cwiseAbs().maxCoeff(), 1e-10);
  }
}

}  // namespace
}  // namespace deltadyn
