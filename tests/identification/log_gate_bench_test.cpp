// The gate on logs of single drives on their bench: coarse encoders, rests, peaks in the torque, delays of several
// samples.

#include <gtest/gtest.h>

#include "deltadyn/identification/log_gate.hpp"

#include "identification/bench_move.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

GateResult examine(const Log& log) {
  static const std::unique_ptr<Robot> robot = make_robot(axis_description(DriveKind::revolute));
  return examine_logs(*robot, {log}, {}, {});
}

std::string verdict_of(const GateResult& result) {
  std::string text;
  for (const LogFinding& f : result.findings) text += "  [" + f.key + "] " + f.text + "\n";
  return text;
}

const LogFinding* timing(const GateResult& result) {
  for (const LogFinding& f : result.findings) {
    if (f.key == "delay" || f.key == "lag") return &f;
  }
  return nullptr;
}

class LogGateBench : public ::testing::TestWithParam<std::tuple<double, bool, double>> {
 protected:
  [[nodiscard]] BenchMove how() const {
    BenchMove move;
    move.rate_hz = std::get<0>(GetParam());
    move.rests = std::get<1>(GetParam());
    move.peak_share = std::get<2>(GetParam());
    return move;
  }
};
INSTANTIATE_TEST_SUITE_P(Logs, LogGateBench,
                         ::testing::Combine(::testing::Values(200.0, 300.0, 500.0), ::testing::Bool(),
                                            ::testing::Values(0.0, 0.01)));

TEST_P(LogGateBench, RemovesADelayOfSomeSamples) {
  std::uint64_t seed = 10;
  for (const double late : {5e-3, 10e-3, 15e-3}) {
    BenchMove move = how();
    move.late_s = late;
    move.seed = ++seed;
    const GateResult result = examine(move.make());
    const LogFinding* found = timing(result);
    ASSERT_NE(found, nullptr) << verdict_of(result);
    EXPECT_NEAR(found->value, late, 0.6e-3) << verdict_of(result);
    // A short one beside peaks in the torque may be said only.
    const bool said = found->level == FindingLevel::warning && move.peak_share > 0 && late < 6e-3;
    EXPECT_TRUE(said || found->level == FindingLevel::mended) << verdict_of(result);
  }
}

TEST_P(LogGateBench, LeavesATorqueInTimeAlone) {
  for (const std::uint64_t seed : {21U, 22U, 23U}) {
    BenchMove move = how();
    move.seed = seed;
    const Log log = move.make();
    const GateResult result = examine(log);
    for (const LogFinding& f : result.findings) EXPECT_EQ(f.level, FindingLevel::fine) << f.text;
    EXPECT_EQ((result.logs[0].tau - log.tau).norm(), 0);
  }
}

// With a vibration that the torque does not know of, the sample's own band shows no delay, or a wrong one: the model's
// band does.
TEST(LogGateBenchBand, IsThatOfTheModel) {
  std::uint64_t seed = 30;
  for (const double vibration : {5.0, 8.0}) {
    for (const double hz : {10.0, 14.0}) {
      for (const double late : {0.0, 5e-3, 12e-3}) {
        BenchMove move;
        move.rate_hz = 500;
        move.rests = false;
        move.encoder_step = 1e-4;
        move.torque_noise = 0.05;
        move.vibration_hz = hz;
        move.vibration = vibration;
        move.late_s = late;
        move.seed = ++seed;
        const GateResult result = examine(move.make());
        const LogFinding* found = timing(result);
        ASSERT_NE(found, nullptr) << verdict_of(result);
        EXPECT_NEAR(found->value, late, std::max(4 * found->std, 0.3e-3)) << verdict_of(result);
        EXPECT_TRUE(late != 0 || found->level == FindingLevel::fine) << verdict_of(result);
        EXPECT_TRUE(late < 0.01 || found->level == FindingLevel::mended) << verdict_of(result);
      }
    }
  }
}

}  // namespace
}  // namespace deltadyn
