#include "../../src/identification/cutoff_scan.hpp"

#include <gtest/gtest.h>

#include "deltadyn/runtime/error.hpp"

#include "identification/synthetic_log.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

TEST(CutoffScan, CoarserEncodersAskForALowerCutoff) {
  const auto robot = make_robot(delta_description("delta3"));
  double last = 1e9;
  for (const double step : {1e-6, 1e-3}) {
    SyntheticOptions synthetic;
    synthetic.torque_noise = 0.1;
    synthetic.base_frequency_hz = 1.0;
    synthetic.encoder_step = step;
    synthetic.with_derivatives = false;
    const auto points = scan_cutoffs(*robot, {synthetic_log(*robot, delta_truth(*robot), synthetic)}, ProcessingOptions{});
    const double best = best_cutoff_hz(points);
    EXPECT_LT(best, last);
    EXPECT_GT(best, 5.0);
    last = best;
    // Too high a cut-off is clearly worse than the best one.
    EXPECT_GT(points.back().score,
              1.05 * std::min_element(points.begin(), points.end(), [](auto& a, auto& b) { return a.score < b.score; })->score);
  }
}

TEST(CutoffScan, RefusesLogsThatAreTooShort) {
  const auto robot = make_robot(delta_description("delta3"));
  SyntheticOptions synthetic;
  synthetic.duration_s = 0.05;
  EXPECT_THROW((void)scan_cutoffs(*robot, {synthetic_log(*robot, delta_truth(*robot), synthetic)}, ProcessingOptions{}), Error);
}

}  // namespace
}  // namespace deltadyn
