#include "deltadyn/simulation/reference_motion.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

/// One drive, sin(2 pi t), `samples` a second.
TrajectorySamples sine(int samples, bool closed) {
  TrajectorySamples s;
  const int n = samples + (closed ? 1 : 0);
  const double w = 2 * std::numbers::pi;
  s.t_s = Eigen::VectorXd::LinSpaced(n, 0, static_cast<double>(n - 1) / samples);
  s.q = (w * s.t_s).array().sin();
  s.qd = w * (w * s.t_s).array().cos();
  s.qdd = -w * w * (w * s.t_s).array().sin();
  return s;
}

TEST(ReferenceMotion, GivesTheSamplesBackAndGoesSmoothlyBetween) {
  const TrajectorySamples samples = sine(50, true);
  const ReferenceMotion motion(samples);
  ReferenceMotion::State state;
  for (Eigen::Index k = 0; k < samples.samples(); ++k) {
    motion.at(static_cast<double>(k) / 50.0, state);
    EXPECT_EQ(state.q(0), samples.q(k, 0));
    EXPECT_EQ(state.qdd(0), samples.qdd(k, 0));
  }
  const double w = 2 * std::numbers::pi;
  for (double t = 0.003; t < 1; t += 0.0171) {
    motion.at(t, state);
    EXPECT_NEAR(state.q(0), std::sin(w * t), 1e-8);
    EXPECT_NEAR(state.qd(0), w * std::cos(w * t), 1e-5);
    EXPECT_NEAR(state.qdd(0), -w * w * std::sin(w * t), 1e-2);
  }
}

TEST(ReferenceMotion, RepeatsPeriodicMotionsWithAndWithoutTheLastSample) {
  for (const bool closed : {true, false}) {
    const ReferenceMotion motion(sine(100, closed), 3);
    EXPECT_NEAR(motion.period_s(), 1, 1e-12);
    EXPECT_NEAR(motion.duration_s(), 3, 1e-12);
    ReferenceMotion::State state;
    for (double t = 0.0031; t < 3; t += 0.0873) {
      motion.at(t, state);
      EXPECT_NEAR(state.q(0), std::sin(2 * std::numbers::pi * t), 1e-9) << t << closed;
    }
  }
}

TEST(ReferenceMotion, StandsStillAfterItsEnd) {
  const ReferenceMotion motion(sine(100, true));
  ReferenceMotion::State state;
  motion.at(5, state);
  EXPECT_NEAR(state.q(0), 0, 1e-12);
  EXPECT_EQ(state.qd(0), 0);
}

TEST(ReferenceMotion, RefusesToRepeatWhatDoesNotEndWhereItBegins) {
  TrajectorySamples samples = sine(100, true);
  samples.q.bottomRows(30).array() += 0.5;
  EXPECT_THROW(ReferenceMotion(samples, 2), Error);
  EXPECT_NO_THROW(ReferenceMotion(samples, 1));
}

}  // namespace
}  // namespace deltadyn
