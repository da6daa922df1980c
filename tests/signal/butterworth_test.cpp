#include "deltadyn/signal/butterworth.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "deltadyn/runtime/error.hpp"

#include "signal/multi_sine.hpp"

namespace deltadyn {
namespace {

using namespace deltadyn::testing_support;

TEST(Butterworth, BothPassesTogetherHaveTheirCutOffWhereAsked) {
  for (int order = 1; order <= 8; ++order) {
    for (const double cutoff : {5.0, 40.0, 300.0}) {
      const auto sections = butterworth_low_pass(1000, single_pass_cutoff_hz(1000, cutoff, order), order);
      EXPECT_NEAR(zero_phase_gain(sections, 1000, cutoff), std::sqrt(0.5), 1e-9) << order << " " << cutoff;
      EXPECT_NEAR(zero_phase_gain(sections, 1000, 0), 1.0, 1e-9);
      EXPECT_NEAR(zero_phase_gain(sections, 1000, 500), 0.0, 1e-12);
    }
  }
}

TEST(ZeroPhaseFilter, HasTheGainOfItsFormulaAndNoLag) {
  const Eigen::VectorXd t = times(1000, 8000);
  for (const double frequency : {3.0, 20.0, 30.0, 45.0}) {
    const Eigen::ArrayXd angle = 2 * std::numbers::pi * frequency * t.array();
    const Eigen::VectorXd out = zero_phase_filter(Eigen::MatrixXd(angle.sin().matrix()), 1000, 30.0, 4);
    const Eigen::Index from = 1000;
    const Eigen::Index count = 6000;  // whole periods of every frequency
    const double in_phase = 2.0 / count * (out.array() * angle.sin()).segment(from, count).sum();
    const double quadrature = 2.0 / count * (out.array() * angle.cos()).segment(from, count).sum();
    const double gain =
        zero_phase_gain(butterworth_low_pass(1000, single_pass_cutoff_hz(1000, 30.0, 4), 4), 1000, frequency);
    EXPECT_NEAR(in_phase, gain, 1e-9) << frequency;
    EXPECT_NEAR(quadrature, 0.0, 1e-9) << frequency;
  }
}

TEST(ZeroPhaseFilter, KeepsStraightLinesUpToTheEnds) {
  const Eigen::VectorXd t = times(1000, 2000);
  Eigen::MatrixXd lines(2000, 2);
  lines << (5.0 + 3.0 * t.array()).matrix(), Eigen::VectorXd::Constant(2000, -7.0);
  for (int order = 1; order <= 6; ++order) {
    const Eigen::MatrixXd out = zero_phase_filter(lines, 1000, 20.0, order);
    // The end of the reflection is a corner of the line; its echo must have died out.
    EXPECT_LT((out - lines).cwiseAbs().maxCoeff(), 1e-5) << order;
  }
}

TEST(ZeroPhaseFilter, IsTheSameBackwards) {
  const Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(
      3000, [](Eigen::Index i) { return std::sin(0.001 * static_cast<double>(i * i % 7001)); });
  const Eigen::VectorXd forwards = zero_phase_filter(x, 1000, 50.0, 3);
  const Eigen::VectorXd backwards = zero_phase_filter(Eigen::MatrixXd(x.reverse()), 1000, 50.0, 3).col(0).reverse();
  EXPECT_LT((forwards - backwards).segment(500, 2000).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(ZeroPhaseFilter, RefusesNonsense) {
  const Eigen::MatrixXd x = Eigen::MatrixXd::Zero(100, 1);
  EXPECT_THROW((void)zero_phase_filter(x, 1000, 0.0, 4), Error);
  EXPECT_THROW((void)zero_phase_filter(x, 1000, -5.0, 4), Error);
  EXPECT_THROW((void)zero_phase_filter(x, 0, 10.0, 4), Error);
  EXPECT_THROW((void)zero_phase_filter(x, 1000, 10.0, 0), Error);
  EXPECT_THROW((void)butterworth_low_pass(1000, 500.0, 4), Error);
}

}  // namespace
}  // namespace deltadyn
