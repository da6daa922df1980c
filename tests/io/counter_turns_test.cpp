// Counters that begin again, on whatever turn the recording starts.

#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <numbers>

#include "deltadyn/io/import_log.hpp"

#include "io/recorded_motion.hpp"
#include "io/temporary_folder.hpp"

namespace deltadyn {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using namespace testing_support;

constexpr double kPi = std::numbers::pi;
constexpr double kCountsPerRad = 20.0 * 8192.0 / (2.0 * kPi);

/// 16 bits of counts of a motor behind a gear of 20, whose encoder has 8192 counts in a turn. `start` [rad] is added to
/// the motion.
Log counted(double lower, double upper, double start, double swing, double offset = 0, double sign = 1) {
  const TemporaryFolder folder;
  RobotDescription robot = one_drive();
  robot.limits[0].lower = lower;
  robot.limits[0].upper = upper;
  const auto row = [&](int, double t) {
    const long counts = std::lround(sign * kCountsPerRad * (start + swing * position(t)) - offset) & 0xFFFF;
    return fmt::format("{:.3f},{},{:.5f}\n", t, counts, torque(t));
  };
  const std::string map = fmt::format(
      "[[channel]]\ndrive = 1\nquantity = \"position\"\nsource = \"Position [cnt]\"\nunit = \"cnt\"\ngear_ratio = 20\n"
      "counts_per_turn = 8192\noffset = {}\nsign = {}\n",
      offset, sign);
  ImportOptions options;
  options.map_file = folder.write("map.toml", map);
  return LogImport({folder.write("log.csv", recorded("t_s,Position [cnt],tau1_Nm\n", row))}, robot, options).log().log;
}

double largest_error(const Log& log, double start, double swing) {
  double largest = 0;
  for (int k = 0; k < kMotionRows; ++k)
    largest = std::max(largest, std::abs(log.q(k, 0) - start - swing * position(0.001 * k)));
  return largest;
}

// One map serves all logs of a machine: the fast one that jumps, the slow one that does not, and those that start
// elsewhere.
TEST(CounterTurns, TheLimitsOfTheRobotFileTellTheTurn) {
  for (const double start : {-0.1, 0.4, 0.6}) {
    for (const double swing : {1.0, 0.1, -0.05}) {
      for (const double sign : {1.0, -1.0}) {
        EXPECT_LT(largest_error(counted(-0.9, 1.6, start, swing, 0, sign), start, swing), 3e-5)
            << start << " " << swing;
        EXPECT_LT(largest_error(counted(-0.9, 1.6, start, swing, 30000, sign), start, swing), 3e-5)
            << start << " " << swing;
      }
    }
  }
  const Log jumping = counted(-0.9, 1.6, 0, -1.0);
  EXPECT_THAT(jumping.notes,
              Contains(HasSubstr("1 jump was taken out; 1 turn of 65536 was subtracted, so that it moves inside "
                                 "the limits of the robot file, -0.9 to 1.6 rad")));
  const Log still = counted(-0.9, 1.6, -0.3, 0.1);
  EXPECT_THAT(still.notes, Contains(HasSubstr("'Position [cnt]': 1 turn of 65536 was subtracted")));
}

TEST(CounterTurns, WhereSeveralTurnsFitOrNoneTheFirstValueIsTakenAndSaidUnlessAnOffsetIsGiven) {
  EXPECT_THAT(counted(-50, 50, 0.1, 1.0).notes, Contains(HasSubstr("turns of the counter fit the limits")));
  EXPECT_THAT(counted(-50, 50, 0.1, 1.0).notes, Contains(HasSubstr("give offset = 65536 [cnt] times")));
  EXPECT_THAT(counted(-0.1, 0.1, 0.1, 1.0).notes, Contains(HasSubstr("the first value taken as it is (offset")));
  EXPECT_THAT(counted(-HUGE_VAL, HUGE_VAL, 0.1, 1.0).notes,
              Contains(HasSubstr("the first value taken as it is (offset")));
  for (const double limit : {50.0, 0.1, HUGE_VAL}) {
    EXPECT_THAT(counted(-limit, limit, 0.1, 1.0, 20).notes, Not(Contains(HasSubstr("as it is"))));
    EXPECT_THAT(counted(-limit, limit, 0.1, 1.0, 20).notes, Contains(HasSubstr("1 jump was taken out")));
  }
}

// A single-turn encoder that shows 350 degrees for -10.
TEST(CounterTurns, AnAngleInsideATurnMovesIntoTheLimits) {
  const TemporaryFolder folder;
  RobotDescription robot = one_drive();
  const auto import = [&](double lower, double upper) {
    robot.limits[0].lower = lower;
    robot.limits[0].upper = upper;
    const auto row = [](int, double t) {
      return fmt::format("{:.3f},{:.6f},{:.5f}\n", t, 360.0 + kDegrees * (0.05 * position(t) - 0.3), torque(t));
    };
    return LogImport({folder.write("log.csv", recorded("t_s,q1_deg,tau1 [Nm]\n", row))}, robot, {}).log().log;
  };
  EXPECT_LT(largest_error(import(-1.0, 1.0), -0.3, 0.05), 1e-6);
  EXPECT_LT(largest_error(import(-7.0, 7.0), 2.0 * kPi - 0.3, 0.05), 1e-6) << "it was inside";
  EXPECT_LT(largest_error(import(2.0, 3.0), 2.0 * kPi - 0.3, 0.05), 1e-6) << "no turn helps";
}

}  // namespace
}  // namespace deltadyn
