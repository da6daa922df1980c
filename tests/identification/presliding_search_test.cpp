#include "deltadyn/identification/presliding_search.hpp"

#include <gtest/gtest.h>

#include "deltadyn/identification/identify.hpp"
#include "deltadyn/identification/validate.hpp"

#include "identification/axis_log.hpp"
#include "identification/synthetic_log.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

std::unique_ptr<Robot> axis_of_tests() {
  return make_robot(axis_description(DriveKind::revolute));
}

double value_of(const Robot& robot, const Eigen::VectorXd& p, const std::string& name) {
  const auto& names = robot.parameter_names();
  return p(std::find(names.begin(), names.end(), name) - names.begin());
}

Identification identified(const Robot& robot, const std::vector<Log>& logs) {
  Eigen::VectorXd prior = Eigen::VectorXd::Constant(robot.parameters(), 0.0);
  prior.head(10) << 2, 0, 0, 0, 0.4, 0.4, 0.4, 0, 0, 0;
  prior.tail(2) << 1, 1;
  return identify(robot, logs, prior, {}, IdentificationOptions{});
}

class Presliding : public ::testing::TestWithParam<double> {};

// The rows near reversals then take part, and friction comes out right.
TEST_P(Presliding, IsFoundFromTheReversals) {
  const auto robot = axis_of_tests();
  std::vector<Log> logs;
  for (const std::uint64_t seed : {1U, 2U}) {
    AxisLog log;
    log.presliding = GetParam();
    log.seed = seed;
    logs.push_back(log.make());
  }
  const Identification result = identified(*robot, logs);
  ASSERT_EQ(result.presliding.size(), 1U);
  EXPECT_NEAR(result.presliding[0].displacement, GetParam(), 0.05 * GetParam());
  EXPECT_LT(std::abs(result.presliding[0].displacement - GetParam()), 4 * result.presliding[0].std);
  EXPECT_NEAR(value_of(*robot, result.fit.p, "drive1.coulomb"), 1.5, 0.015);
  EXPECT_NEAR(value_of(*robot, result.fit.p, "drive1.viscous"), 0.8, 0.016);
  EXPECT_LT(result.drives[0].masked_rows, result.drives[0].rows / 20);

  AxisLog fresh;
  fresh.presliding = GetParam();
  fresh.seed = 7;
  const Validation validation = validate(*robot, {fresh.make()}, result.fit.p, result.processing);
  EXPECT_LT(validation.drives[0].rms_with_reversals, 1.15 * result.drives[0].rms);
}

INSTANTIATE_TEST_SUITE_P(Displacements, Presliding, ::testing::Values(1.5e-3, 4e-3, 1e-2));

class BristleDamping : public ::testing::TestWithParam<std::pair<double, double>> {};

// Its torque about reversals follows the acceleration: unseen, it makes inertia come out too large and the displacement
// too small.
TEST_P(BristleDamping, IsFoundAndLeavesTheInertiaAlone) {
  const auto robot = axis_of_tests();
  const auto [displacement, damping_s] = GetParam();
  std::vector<Log> logs;
  for (const std::uint64_t seed : {11U, 12U}) {
    AxisLog log;
    log.presliding = displacement;
    log.bristle_damping_s = damping_s;
    log.seed = seed;
    logs.push_back(log.make());
  }
  const Identification result = identified(*robot, logs);
  ASSERT_EQ(result.presliding.size(), 1U);
  EXPECT_NEAR(result.presliding[0].damping_s, damping_s,
              std::max(4 * result.presliding[0].damping_std_s, 0.1 * damping_s));
  EXPECT_NEAR(result.presliding[0].displacement, displacement, 0.05 * displacement);
  EXPECT_NEAR(value_of(*robot, result.fit.p, "upper_arm.Iyy"), 0.4, 0.002);
  EXPECT_NEAR(value_of(*robot, result.fit.p, "drive1.coulomb"), 1.5, 0.015);
  EXPECT_NEAR(value_of(*robot, result.fit.p, "drive1.viscous"), 0.8, 0.016);
}

INSTANTIATE_TEST_SUITE_P(Bristles, BristleDamping,
                         ::testing::Values(std::pair(1.5e-3, 2e-3), std::pair(4e-3, 1.5e-3), std::pair(1e-2, 4e-3)));

TEST(FindPresliding, NamesNoDampingWhereThereIsNone) {
  const auto robot = axis_of_tests();
  for (const std::uint64_t seed : {21U, 22U, 23U, 24U}) {
    AxisLog log;
    log.presliding = 3e-3;
    log.seed = seed;
    ProcessingOptions processing;
    processing.cutoff_hz = 20;
    const auto found = find_presliding(*robot, find_base_parameters(*robot), {log.make()}, processing);
    EXPECT_EQ(found[0].damping_s, 0.0) << seed;
    EXPECT_GT(found[0].displacement, 2.7e-3) << seed;
  }
}

TEST(FindPresliding, FindsNoneWhereCoulombsLawHolds) {
  const auto robot = axis_of_tests();
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    AxisLog log;
    log.seed = seed;
    ProcessingOptions processing;
    processing.cutoff_hz = 20;
    const auto found = find_presliding(*robot, find_base_parameters(*robot), {log.make()}, processing);
    EXPECT_LT(found[0].displacement, 3e-4);  // what a filter of 20 Hz cannot tell from a step
  }
}

// A position that jitters by the steps of its encoder rounds the reversals of Coulomb's friction.
TEST(FindPresliding, FindsNoneBelowTheStepsOfACoarseEncoder) {
  const auto robot = make_robot(delta_description("delta4"));
  for (const std::uint64_t seed : {5000U, 5003U}) {
    ProcessingOptions processing;
    processing.cutoff_hz = 26;
    for (const PreslidingJoint& joint :
         find_presliding(*robot, find_base_parameters(*robot),
                         {synthetic_log(*robot, delta_truth(*robot), coarse_recording(seed))}, processing))
      EXPECT_EQ(joint.displacement, 0) << seed;
  }
}

}  // namespace
}  // namespace deltadyn
