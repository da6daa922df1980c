#include "deltadyn/trajectory/motion_plan.hpp"

#include <gmock/gmock.h>

#include "deltadyn/runtime/error.hpp"

#include "support/descriptions.hpp"
#include "support/matchers.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using testing_support::IsNear;
using testing_support::Random;

class MotionPlanTest : public ::testing::Test {
 protected:
  MotionPlanTest() : robot(make_robot(testing_support::delta_description("delta4"))), limits(robot->description()) {
    limits.qd << 6, 6, 6, 48;
    limits.qdd << 60, 60, 60, 240;
    limits.q_lower << -0.9, -0.9, -0.9, -50;
    limits.q_upper << 1.6, 1.6, 1.6, 50;
    Region region;
    region.centre = {0, 0, -0.9};
    region.radius = 0.25;
    limits.region = region;
  }
  /// A random series, made so large that one of its limits binds.
  PlanSegment segment(std::uint64_t seed, int periods) {
    Random random(seed);
    const Eigen::Vector4d centre(0, 0, -0.9, 0);
    FourierSeries series{random.uniform(0.4, 0.9), Eigen::MatrixXd(7, 4)};
    for (Eigen::Index k = 0; k < series.coefficients.size(); ++k) series.coefficients(k) = 0.05 * random.uniform(-1, 1);
    series.coefficients.col(3) *= 50;
    series.coefficients.row(0) = centre.transpose();
    series = on_sample_grid(series, 1000);
    double low = 0, high = 20;
    for (int k = 0; k < 30; ++k) {
      const double middle = (low + high) / 2;
      (check_limits(*robot, limits, one_period(series.scaled(centre, middle)), 2000).margin() > 1e-4 ? low : high) =
          middle;
    }
    return {series.scaled(centre, low), limits, periods};
  }

  std::unique_ptr<Robot> robot;
  MotionLimits limits;
};

TEST_F(MotionPlanTest, StartsAndEndsAtRestAndKeepsItsLimits) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const std::vector<PlanSegment> segments = {segment(seed, 3)};
    const MotionPlan plan = make_plan(*robot, segments, 1000, false);
    ASSERT_EQ(plan.parts.size(), 3U);
    EXPECT_GE(check_plan(*robot, segments, plan).margin(), 0) << "seed " << seed;
    for (const double t : {0.0, plan.duration_s}) {
      EXPECT_THAT(plan.at(t).zd, IsNear(Eigen::VectorXd::Zero(4), 1e-9));
      EXPECT_THAT(plan.at(t).zdd, IsNear(Eigen::VectorXd::Zero(4), 1e-6));
    }
  }
}

TEST_F(MotionPlanTest, PartsJoinSmoothlyAndRatesAreSlopes) {
  const std::vector<PlanSegment> segments = {segment(1, 2), segment(2, 1), segment(3, 1)};
  const MotionPlan plan = make_plan(*robot, segments, 1000, false);
  ASSERT_EQ(plan.parts.size(), 3U * 3U + 2U);
  for (std::size_t k = 1; k < plan.parts.size(); ++k) {
    const SmoothMotion& before = plan.parts[k - 1].motion;
    const TaskState end = before.at(before.duration_s), start = plan.parts[k].motion.at(0);
    EXPECT_THAT(start.z, IsNear(end.z, 1e-9)) << k;
    EXPECT_THAT(start.zd, IsNear(end.zd, 1e-8)) << k;
    EXPECT_THAT(start.zdd, IsNear(end.zdd, 1e-6)) << k;
  }
  constexpr double kStep = 1e-5;
  for (double t = 0.05; t < plan.duration_s - 0.05; t += 0.0937) {
    const TaskState up = plan.at(t + kStep), down = plan.at(t - kStep), at = plan.at(t);
    EXPECT_THAT(at.zd, IsNear(((up.z - down.z) / (2 * kStep)).eval(), 1e-5));
    EXPECT_THAT(at.zdd, IsNear(((up.zd - down.zd) / (2 * kStep)).eval(), 2e-2));
  }
}

TEST_F(MotionPlanTest, SamplesAreThePlanAtTheRate) {
  const std::vector<PlanSegment> segments = {segment(5, 2)};
  const MotionPlan plan = make_plan(*robot, segments, 500, false);
  const TrajectorySamples samples = sample_plan(*robot, plan, 500);
  EXPECT_NEAR(samples.t_s(samples.samples() - 1), plan.duration_s, 1e-9);
  for (Eigen::Index row = 0; row < samples.samples(); row += 97) {
    EXPECT_THAT(samples.task(row).zdd, IsNear(plan.at(samples.t_s(row)).zdd, 1e-12));
    Eigen::VectorXd q(4);
    ASSERT_EQ(robot->inverse_kinematics(samples.task(row).z, q), Status::ok);
    EXPECT_THAT(samples.q.row(row).transpose().eval(), IsNear(q, 1e-12));
  }
}

TEST_F(MotionPlanTest, PeriodicPartAloneRepeatsAfterAWholeNumberOfSamples) {
  const std::vector<PlanSegment> segments = {segment(6, 2)};
  const MotionPlan plan = make_plan(*robot, segments, 1000, true);
  ASSERT_EQ(plan.parts.size(), 1U);
  const TrajectorySamples samples = sample_plan(*robot, plan, 1000);
  const auto period = static_cast<Eigen::Index>(std::lround(segments[0].series.period_s() * 1000));
  EXPECT_NEAR(segments[0].series.period_s() * 1000, static_cast<double>(period), 1e-9);
  ASSERT_EQ(samples.samples(), 2 * period + 1);
  EXPECT_THAT(samples.z.topRows(period).eval(), IsNear(samples.z.middleRows(period, period).eval(), 1e-9));
  EXPECT_THROW((void)make_plan(*robot, {segment(6, 1), segment(7, 1)}, 1000, true), Error);
}

}  // namespace
}  // namespace deltadyn
