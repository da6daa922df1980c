// The search as a whole. The long studies are run by hand, see tests/excitation/excitation_study_test.cpp.

#include "deltadyn/excitation/optimize.hpp"

#include <gmock/gmock.h>
#include <omp.h>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/trajectory/motion_plan.hpp"

#include "excitation/excitation_setup.hpp"

namespace deltadyn {
namespace {

using ::testing::HasSubstr;
using testing_support::excitation_setup;
using testing_support::ExcitationSetup;

ExcitationOptions short_search(std::uint64_t seed = 1) {
  ExcitationOptions options;
  options.harmonics = 3;
  options.starts = 3;
  options.seed = seed;
  options.time_limit_s = 250;  // ends by its evaluations
  return options;
}

TEST(OptimizeExcitation, BeatsRandomMotionsByFar) {
  const ExcitationSetup setup = excitation_setup("delta3", 600);
  const DesignBound bound = design_bound(setup.space);
  const ExcitationOptions options = short_search();
  const Excitation found = optimize_excitation(setup.space, *setup.limits, bound, options);
  EXPECT_GT(found.margin(), 0);
  EXPECT_GT(found.d_efficiency, 0.4);
  EXPECT_FALSE(found.out_of_time);
  EXPECT_EQ(found.finished_starts, found.starts);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const FourierSeries random = random_feasible_series(setup.space, *setup.limits, options, seed);
    EXPECT_GT(check_limits(*setup.robot, *setup.limits, one_period(random), 2000).margin(), 0);
    const double efficiency = d_efficiency(log_determinant(series_information(setup.space, random)), bound, 18);
    EXPECT_LT(efficiency, 0.6 * found.d_efficiency);
  }
}

TEST(OptimizeExcitation, SameSeedSameResultWhateverTheThreads) {
  const ExcitationSetup setup = excitation_setup("delta3", 400);
  const DesignBound bound = design_bound(setup.space);
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const Excitation one = optimize_excitation(setup.space, *setup.limits, bound, short_search());
  omp_set_num_threads(3);
  const Excitation three = optimize_excitation(setup.space, *setup.limits, bound, short_search());
  omp_set_num_threads(before);
  EXPECT_EQ(one.segments[0].series.coefficients, three.segments[0].series.coefficients);
  EXPECT_EQ(one.segments[0].series.base_frequency_hz, three.segments[0].series.base_frequency_hz);
  EXPECT_EQ(one.evaluations, three.evaluations);
  const Excitation other = optimize_excitation(setup.space, *setup.limits, bound, short_search(2));
  EXPECT_NE(one.segments[0].series.coefficients, other.segments[0].series.coefficients);
}

TEST(OptimizeExcitation, GivesTheBestSoFarWhenStopped) {
  const ExcitationSetup setup = excitation_setup("delta4", 400);
  const DesignBound bound = design_bound(setup.space);
  std::atomic<bool> stop{true};
  ExcitationOptions options = short_search();
  options.stop = &stop;
  const Excitation found = optimize_excitation(setup.space, *setup.limits, bound, options);
  EXPECT_TRUE(found.interrupted);
  EXPECT_GT(found.margin(), 0);
  EXPECT_GT(found.d_efficiency, 0);
  options.stop = nullptr;
  options.time_limit_s = 1e-3;
  const Excitation late = optimize_excitation(setup.space, *setup.limits, bound, options);
  EXPECT_TRUE(late.out_of_time);
  EXPECT_GT(late.margin(), 0);
  EXPECT_THAT(late.brief_report(), HasSubstr("stopped by the time limit"));
}

TEST(OptimizeExcitation, SegmentsTogetherGiveMoreThanOne) {
  const ExcitationSetup setup = excitation_setup("delta3", 400);
  const DesignBound bound = design_bound(setup.space);
  ExcitationOptions options = short_search();
  options.starts = 1;
  const double one = optimize_excitation(setup.space, *setup.limits, bound, options).d_efficiency;
  options.speeds = {1.0, 1.0};
  const Excitation two = optimize_excitation(setup.space, *setup.limits, bound, options);
  EXPECT_EQ(two.segments.size(), 2U);
  EXPECT_GT(two.d_efficiency, one);
  options.speeds = {0.3, 1.0};
  const Excitation slow = optimize_excitation(setup.space, *setup.limits, bound, options);
  EXPECT_LE(slow.segments[0].limits.qd(0), 0.3 * setup.limits->qd(0));
  EXPECT_GT(slow.margin(), 0);
}

TEST(OptimizeExcitation, TheVelocityWeightMakesItFaster) {
  const ExcitationSetup setup = excitation_setup("axis", 400);
  const DesignBound bound = design_bound(setup.space);
  ExcitationOptions options = short_search();
  const auto speed = [&](double weight) {
    options.velocity_weight = weight;
    const FourierSeries series = optimize_excitation(setup.space, *setup.limits, bound, options).segments[0].series;
    return series.at_phases(even_phases(200), 1).squaredNorm();
  };
  EXPECT_GT(speed(20), 1.01 * speed(0));
}

TEST(OptimizeExcitation, RefusesOptionsThatCannotBe) {
  const auto message_of = [](const ExcitationOptions& options) -> std::string {
    try {
      options.validate();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::usage);
      return e.what();
    }
    return "no error";
  };
  ExcitationOptions options;
  EXPECT_EQ(message_of(options), "no error");
  options.lowest_hz = 2;
  EXPECT_THAT(message_of(options), HasSubstr("--base-frequency-hz"));
  options = {};
  options.rate_hz = 50;
  EXPECT_THAT(message_of(options), HasSubstr("at least 100 Hz"));
  options = {};
  options.speeds = {2};
  EXPECT_THAT(message_of(options), HasSubstr("--segment-speeds"));
  options = {};
  options.harmonics = 0;
  EXPECT_THAT(message_of(options), HasSubstr("--harmonics"));
}

}  // namespace
}  // namespace deltadyn
