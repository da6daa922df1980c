#include "deltadyn/identification/identify.hpp"

#include <Eigen/LU>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deltadyn/runtime/effect_states.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/plausibility.hpp"

#include "identification/fit_problems.hpp"
#include "identification/synthetic_log.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;
using ::testing::Contains;
using ::testing::HasSubstr;

std::vector<Log> recorded(const Robot& robot, double outlier = 0) {
  std::vector<Log> logs;
  for (const std::uint64_t seed : {1U, 2U}) {
    SyntheticOptions synthetic;
    synthetic.duration_s = 6;
    synthetic.torque_noise = 0.05;
    synthetic.encoder_step = 1.2e-5;
    synthetic.with_derivatives = false;
    synthetic.seed = seed;
    synthetic.base_frequency_hz = seed == 1 ? 0.35 : 0.15;
    logs.push_back(synthetic_log(robot, delta_truth(robot), synthetic));
    if (outlier > 0) {
      for (Eigen::Index k = 0; k < logs.back().samples(); k += 1500) logs.back().tau(k, 0) += outlier;
    }
  }
  return logs;
}

double friction_error(const Robot& robot, const Identification& result) {
  const Eigen::VectorXd truth = delta_truth(robot);
  double worst = 0;
  for (int k = 0; k < robot.parameters(); ++k) {
    if (robot.parameter_names()[static_cast<std::size_t>(k)].find("drive") == 0)
      worst = std::max(worst, std::abs(result.fit.p(k) / truth(k) - 1));
  }
  return worst;
}

TEST(Identify, RecoversWhatTheDataShowFromTwoPriors) {
  const auto robot = make_robot(delta_description("delta4"));
  const Eigen::VectorXd truth = delta_truth(*robot);
  const std::vector<Log> logs = recorded(*robot);
  Eigen::VectorXd last;
  for (const double scale : {0.7, 1.3}) {
    const Identification result = identify(*robot, logs, scale * truth, {}, IdentificationOptions{});
    EXPECT_TRUE(result.fit.converged);
    EXPECT_EQ(result.base.count(), 37);
    EXPECT_LT(friction_error(*robot, result), 0.01);
    const Eigen::VectorXd sigmas =
        (result.base_from_fit - result.base.B * truth).cwiseQuotient(result.base_estimate.std());
    EXPECT_LT(sigmas.cwiseAbs().maxCoeff(), 4.5);
    for (const DriveReport& drive : result.drives) EXPECT_LT(drive.rms, 1.02 * drive.rms_base);
    if (last.size() > 0) {
      EXPECT_LT((result.base_from_fit - last).cwiseQuotient(result.base_estimate.std()).cwiseAbs().maxCoeff(), 0.2);
    }
    last = result.base_from_fit;
  }
}

TEST(Identify, HuberWeightsResistOutliers) {
  const auto robot = make_robot(delta_description("delta3"));
  const Eigen::VectorXd truth = delta_truth(*robot);
  std::vector<Log> logs;
  for (Log& log : recorded(*robot, 300.0)) logs.push_back(log);
  IdentificationOptions options;
  options.choose_cutoff = false;
  const Identification plain = identify(*robot, logs, 0.8 * truth, {}, options);
  options.robust = true;
  const Identification robust = identify(*robot, logs, 0.8 * truth, {}, options);
  const Eigen::VectorXd beta = plain.base.B * truth;
  const Eigen::MatrixXd information = robust.base_estimate.covariance.inverse();
  const auto distance = [&](const Identification& result) {
    const Eigen::VectorXd error = result.base_estimate.value - beta;
    return std::sqrt(error.dot(information * error));
  };
  EXPECT_LT(distance(robust), 0.5 * distance(plain));
}

/// Adds a force that no parameter explains and that lifts the plate [N].
void lift(const Robot& robot, double force, Log& log) {
  const auto plate = make_effect_states(robot.description());
  EffectState state;
  for (Eigen::Index k = 0; k < log.samples(); ++k) {
    ASSERT_EQ(plate->at(log.q.row(k).transpose(), log.qd.row(k).transpose(), log.qdd.row(k).transpose(), state),
              Status::ok);
    log.tau.row(k) -= (state.J.transpose() * Eigen::Vector3d(0, 0, force)).transpose();
  }
}

std::string implausible_bodies(const Robot& robot, const Eigen::VectorXd& p) {
  std::string found;
  for (Eigen::Index k = 0; k < p.size(); ++k) {
    const ParameterId& id = robot.parameter_ids()[static_cast<std::size_t>(k)];
    if (id.kind != ParameterKind::inertial || id.entry != 0) continue;
    try {
      plausibility::require_body(robot.description(), id.body, p.segment<10>(k), owner_name(id), "");
    } catch (const Error& error) {
      found += std::string(error.what()) + "; ";
    }
  }
  return found;
}

TEST(Identify, RaisesLambdaUntilEveryBodyIsAPartOfSuchARobot) {
  const auto robot = make_robot(leaning_delta({0.4, -0.3, 0.2}));
  const Eigen::VectorXd truth = 0.1 * delta_truth(*robot);
  SyntheticOptions recording;
  recording.torque_noise = 0.02;
  const Log unloaded = synthetic_log(*robot, truth, recording);
  for (const double force : {5.0, 50.0}) {
    std::vector<Log> logs = {unloaded};
    lift(*robot, force, logs.front());
    IdentificationOptions options;
    const Identification result = identify(*robot, logs, 0.8 * truth, {}, options);
    EXPECT_TRUE(result.fit.converged) << result.fit.brief_report();
    EXPECT_EQ(implausible_bodies(*robot, result.fit.p), "");
    EXPECT_THAT(result.fit.notes, Contains(HasSubstr("lambda was raised")));
    EXPECT_TRUE(result.fit.lambda_from_data);
    EXPECT_GT(result.fit.lambda, 1.0) << "by no less the masses come back";
    options.fit.regularization = 1e-8;
    EXPECT_NE(implausible_bodies(*robot, identify(*robot, logs, 0.8 * truth, {}, options).fit.p), "")
        << "the test must be a hard one";
  }
}

TEST(Identify, RefusesWithoutLogs) {
  const auto robot = make_robot(delta_description("delta3"));
  EXPECT_THROW((void)identify(*robot, {}, delta_truth(*robot), {}, IdentificationOptions{}), Error);
}

}  // namespace
}  // namespace deltadyn
