#include "../../src/identification/noise_bias.hpp"

#include <gtest/gtest.h>

#include "deltadyn/signal/motion_band.hpp"

#include "../../src/identification/least_squares.hpp"
#include "identification/axis_log.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

struct Estimates {
  Eigen::VectorXd plain, compensated;
  Eigen::Index inertia = 0;  ///< place of the moving inertia
};

Estimates estimates(const AxisLog& axis, double cutoff_hz) {
  const auto robot = make_robot(axis_description(DriveKind::revolute));
  const BaseParameters base = find_base_parameters(*robot);
  ProcessingOptions processing;
  processing.cutoff_hz = cutoff_hz;
  const std::vector<Log> logs = {axis.make()};
  const DataFold fold = fold_log(*robot, prepare_log(*robot, logs.front(), processing));
  const NoiseBias bias = noise_bias(*robot, base, logs, processing, {false}, choose_cutoff(logs).cutoff_hz);
  Estimates out;
  out.plain = estimate_base_parameters(base, fold.regular).value;
  out.compensated = estimate_base_parameters(base, fold.regular, {}, &bias).value;
  const auto inertia = std::find_if(base.expressions.begin(), base.expressions.end(),
                                    [](const std::string& name) { return name.find("Iyy") != std::string::npos; });
  out.inertia = inertia - base.expressions.begin();
  return out;
}

// At cut-offs where an encoder of 12 bits is felt in the accelerations, the inertia stays what it is.
TEST(NoiseBias, TakesTheAttenuationOut) {
  AxisLog axis;
  axis.encoder_bits = 12;
  axis.duration_s = 30;
  axis.base_hz = 1.03;  // some counts a sample: the quantisation is white
  for (const double cutoff_hz : {70.0, 90.0}) {
    double plain = 0, compensated = 0;
    constexpr int kLogs = 4;
    for (int seed = 1; seed <= kLogs; ++seed) {
      axis.seed = static_cast<std::uint64_t>(seed);
      const Estimates found = estimates(axis, cutoff_hz);
      plain += found.plain(found.inertia) / axis.inertia / kLogs;
      compensated += found.compensated(found.inertia) / axis.inertia / kLogs;
    }
    EXPECT_LT(plain, 0.985) << cutoff_hz;
    EXPECT_NEAR(compensated, 1.0, 0.25 * (1 - plain)) << cutoff_hz;
  }
}

TEST(NoiseBias, LeavesFineEncodersAlone) {
  AxisLog axis;
  axis.encoder_bits = 22;
  const Estimates found = estimates(axis, 20);
  EXPECT_LT((found.plain - found.compensated).cwiseAbs().maxCoeff(), 1e-5 * found.plain.cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace deltadyn
