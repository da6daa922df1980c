#include "deltadyn/simulation/simulate.hpp"

#include <gtest/gtest.h>
#include <memory>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/signal/log_check.hpp"

#include "identification/synthetic_log.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using testing_support::delta_description;
using testing_support::delta_truth;

struct Bench {
  explicit Bench(double duration_s = 1.5) {
    p = delta_truth(*robot);
    testing_support::SyntheticOptions options;
    options.duration_s = duration_s;
    options.base_frequency_hz = 0.4;
    const Log log = testing_support::synthetic_log(*robot, p, options);
    samples.t_s = log.t_s;
    samples.q = log.q;
    samples.qd = log.qd;
    samples.qdd = log.qdd;
  }
  [[nodiscard]] SimulationResult run(const SimulationOptions& options) const {
    Plant plant(robot->description(), robot->parameter_names(), p, {}, options.plant);
    return simulate(plant, *robot, p, ReferenceMotion(samples), {}, options);
  }
  std::unique_ptr<Robot> robot = make_robot(delta_description("delta4"));
  Eigen::VectorXd p;
  TrajectorySamples samples;
};

class EveryLaw : public ::testing::TestWithParam<ControlLaw> {};

TEST_P(EveryLaw, FollowsAndItsTorqueIsThatOfTheMotion) {
  const Bench bench;
  SimulationOptions options;
  options.controller.law = GetParam();
  const SimulationResult result = bench.run(options);
  EXPECT_LT(result.rms_error.maxCoeff(), 2e-3);
  EXPECT_LT(std::abs(result.energy_change - result.work + result.losses), 1e-8 * (1 + result.losses));
  Eigen::VectorXd tau(4), rates(5);
  int wrong = 0;
  for (Eigen::Index k = 1; k < result.log.samples(); ++k) {
    ASSERT_EQ(bench.robot->inverse_dynamics(result.log.q.row(k).transpose(), result.log.qd.row(k).transpose(),
                                            result.log.qdd.row(k).transpose(), bench.p, tau),
              Status::ok);
    if ((tau - result.log.tau.row(k).transpose()).cwiseAbs().maxCoeff() > 1e-6) ++wrong;
  }
  // Where a joint is stuck, or turns within the two stairs of a sample, the model with sign(rate) has no torque to say.
  EXPECT_LT(wrong, 3 + 2 * static_cast<int>(result.counts.reversals) + static_cast<int>(1000 * result.counts.stuck_s));
}

TEST_P(EveryLaw, FollowsWithoutKnowingTheRobotExactly) {
  const Bench bench;
  SimulationOptions options;
  options.controller.law = GetParam();
  Plant plant(bench.robot->description(), bench.robot->parameter_names(), bench.p);
  const SimulationResult result =
      simulate(plant, *bench.robot, 0.8 * bench.p, ReferenceMotion(bench.samples), {}, options);
  EXPECT_LT(result.rms_error.maxCoeff(), 0.03);
  EXPECT_GT(result.rms_error.maxCoeff(), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Laws, EveryLaw,
                         ::testing::Values(ControlLaw::pd_feedforward, ControlLaw::computed_torque,
                                           ControlLaw::augmented_pd));

TEST(Simulate, IsTheSameForTheSameSeedOnly) {
  const Bench bench(0.7);
  SimulationOptions options;
  options.sensors.encoder_step = std::vector<double>(4, 1e-5);
  options.sensors.encoder_noise = std::vector<double>(4, 1e-5);
  options.sensors.torque_noise = std::vector<double>(4, 0.1);
  const SimulationResult a = bench.run(options), b = bench.run(options);
  EXPECT_EQ(a.log.q, b.log.q);
  EXPECT_EQ(a.log.tau, b.log.tau);
  options.seed = 2;
  EXPECT_NE(a.log.tau, bench.run(options).log.tau);
}

TEST(Simulate, ItsLogPassesTheCheckOfLogs) {
  const Bench bench;
  SimulationOptions options;
  options.sensors.encoder_step = std::vector<double>(4, 1.2e-5);
  options.sensors.torque_noise = std::vector<double>(4, 0.05);
  Log log = bench.run(options).log;
  log.qd.resize(0, 0);
  log.qdd.resize(0, 0);
  check_and_repair(log, bench.robot->description());
  EXPECT_TRUE(log.filled.empty());
  EXPECT_TRUE(log.notes.empty());
}

TEST(Simulate, AFasterControllerThanTheLogAndALateBeginning) {
  const Bench bench(1.0);
  SimulationOptions options;
  options.control_rate_hz = 4000;
  options.log_rate_hz = 500;
  options.discard_s = 0.3;
  const SimulationResult result = bench.run(options);
  EXPECT_EQ(result.log.samples(), 350);
  EXPECT_EQ(result.log.t_s(0), 0);
  EXPECT_NEAR(result.log.sample_time_s(), 0.002, 1e-12);
}

TEST(Simulate, AMotorThatIsTooWeakIsTold) {
  Bench bench(1.0);
  RobotDescription weak = bench.robot->description();
  for (DriveLimits& limits : weak.limits) limits.effort = 10;
  bench.robot = make_robot(weak);
  try {
    EXPECT_GT(bench.run({}).clipped, 0);
  } catch (const Error& error) {  // far too weak: the robot falls
    EXPECT_EQ(error.code(), ExitCode::no_convergence);
  }
}

TEST(SimulationOptions, NameWhatIsWrong) {
  const Bench bench(0.6);
  SimulationOptions options;
  options.control_rate_hz = 1500;
  EXPECT_THROW((void)bench.run(options), Error);
  options = {};
  options.controller.kp = {1, 2};
  EXPECT_THROW((void)bench.run(options), Error);
  options = {};
  options.discard_s = 5;
  EXPECT_THROW((void)bench.run(options), Error);
}

}  // namespace
}  // namespace deltadyn
