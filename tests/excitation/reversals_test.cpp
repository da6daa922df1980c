#include "deltadyn/excitation/reversals.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "deltadyn/excitation/optimize.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/trajectory/motion_plan.hpp"

#include "../../src/excitation/design_problem.hpp"
#include "excitation/excitation_setup.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using testing_support::excitation_setup;
using testing_support::ExcitationSetup;
using testing_support::Random;

TEST(Reversals, ReachIsThatOfTheLowPassAndShrinksWithItsCutOff) {
  EXPECT_GT(reversal_reach_s(20, 1000), 1.9 * reversal_reach_s(40, 1000));
  EXPECT_NEAR(reversal_reach_s(62.5, 1000), 0.041, 0.001);  // half of 5.02 / 62.5 Hz, up to a whole sample
  EXPECT_THROW((void)reversal_reach_s(600, 1000), Error);
}

TEST(Reversals, AnAxisThatSwingsTwiceASecondLosesTwiceTheReachAReversal) {
  const ExcitationSetup setup = excitation_setup("axis", 100);
  TrajectorySamples samples;
  const Eigen::Index count = 10000;
  samples.t_s = Eigen::VectorXd::LinSpaced(count, 0, 9.999);
  samples.q = (2 * std::numbers::pi * 2 * samples.t_s.array()).sin().matrix();
  samples.qd = (4 * std::numbers::pi * (2 * std::numbers::pi * 2 * samples.t_s.array()).cos()).matrix();
  const double share = share_away_from_reversals(*setup.robot, samples, 0.03, 0)(0);
  EXPECT_NEAR(share, 1 - 4 * (2 * 0.03 + 0.002), 1e-3);  // four reversals a second, each between two samples
}

TEST(Reversals, SmoothDistanceIsAHalfAtTheReachAndItsSlopesAreRight) {
  EXPECT_NEAR(distance_from_reversal(2 * 0.04, 2, 0.04, 0).value, 0.5, 1e-12);
  EXPECT_EQ(distance_from_reversal(0, 2, 0.04, 0).value, 0);
  EXPECT_EQ(distance_from_reversal(0, 0, 0.04, 0).value, 0);
  EXPECT_GT(distance_from_reversal(1, 2, 0.04, 0).value, 0.999);
  const double h = 1e-6;
  for (const double rate : {-0.3, 0.1, 0.5}) {
    for (const double acceleration : {-5.0, 3.0}) {
      const auto at = [&](double v, double a) { return distance_from_reversal(v, a, 0.05, 0.1).value; };
      const SmoothDistance d = distance_from_reversal(rate, acceleration, 0.05, 0.1);
      EXPECT_NEAR(d.by_rate, (at(rate + h, acceleration) - at(rate - h, acceleration)) / (2 * h), 1e-7);
      EXPECT_NEAR(d.by_acceleration, (at(rate, acceleration + h) - at(rate, acceleration - h)) / (2 * h), 1e-7);
    }
  }
}

TEST(Reversals, ConstraintsOfTheSearchHaveTheSlopesTheySay) {
  for (const std::string type : {"delta3", "delta4", "linear-delta3", "axis"}) {
    const ExcitationSetup setup = excitation_setup(type, 200);
    detail::ProblemSettings settings;
    settings.harmonics = 3;
    settings.samples = 50;
    settings.reversal_reach_s = 0.08;
    settings.least_away = 0.5;
    const detail::DesignProblem problem(setup.space, *setup.limits, settings);
    Random random(7);
    Eigen::VectorXd v(problem.variables());
    for (Eigen::Index k = 0; k < v.size(); ++k) v(k) = 0.15 * random.uniform(-1, 1);
    v(v.size() - 1) = 0.5;
    FourierSeries series = problem.series(v);
    series.coefficients.row(0) = setup.space.states.centre.transpose();
    v = problem.variables_of(series);
    const int n = setup.robot->drives();
    detail::DesignProblem::Evaluation e, up, down;
    problem.evaluate(v, true, e);
    ASSERT_TRUE(e.regular);
    ASSERT_EQ(e.constraints.size(), problem.constraints());
    const double h = 2e-7;  // short: where a rate only touches zero, the distance has a sharp edge
    for (Eigen::Index k = 0; k < v.size(); ++k) {
      Eigen::VectorXd shifted = v;
      shifted(k) += h;
      problem.evaluate(shifted, false, up);
      shifted(k) -= 2 * h;
      problem.evaluate(shifted, false, down);
      const Eigen::VectorXd slope = (up.constraints.tail(n) - down.constraints.tail(n)) / (2 * h);
      EXPECT_LT((slope - e.jacobian.row(k).tail(n).transpose()).norm(), 1e-5 * (1 + slope.norm()))
          << type << ", variable " << k;
    }
  }
}

TEST(Reversals, TheSearchKeepsEveryDriveAwayFromThem) {
  const ExcitationSetup setup = excitation_setup("delta4", 300);
  const DesignBound bound = design_bound(setup.space);
  ExcitationOptions options;
  options.harmonics = 4;
  options.starts = 2;
  options.time_limit_s = 300;
  options.reversal_reach_s = 0.04;
  options.least_away = 0.6;
  const auto share_of = [&] {
    const Excitation e = optimize_excitation(setup.space, *setup.limits, bound, options);
    const std::vector<PlanSegment> segments = {{e.segments[0].series, e.segments[0].limits, 1}};
    return share_away_from_reversals(*setup.robot,
                                     sample_plan(*setup.robot, make_plan(*setup.robot, segments, 1000, true), 1000),
                                     options.reversal_reach_s, 0.003)
        .minCoeff();
  };
  EXPECT_GT(share_of(), 0.58);
  options.least_away = 0;
  EXPECT_LT(share_of(), 0.53);
}

}  // namespace
}  // namespace deltadyn
