#include "deltadyn/signal/log_check.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gmock/gmock.h>
#include <limits>
#include <numbers>
#include <random>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/random.hpp"

#include "signal/multi_sine.hpp"

namespace deltadyn {
namespace {

using namespace deltadyn::testing_support;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

RobotDescription delta3() {
  RobotDescription robot;
  robot.type = "delta3";
  robot.limbs.resize(3);
  robot.parts.resize(1);
  robot.limits.resize(3);
  return robot;
}

/// Ten seconds of three drives; sample i stands in line i + 2.
Log good_log() {
  std::mt19937_64 random(23);
  NormalDistribution normal(0.0, 0.1);
  Log log;
  log.file = "log.csv";
  log.t_s = times(1000, 10000);
  log.q.resize(10000, 3);
  log.tau.resize(10000, 3);
  for (int d = 0; d < 3; ++d) {
    log.q.col(d) = quantised(MultiSine{}.at(log.t_s, 0, 2.1 * d), 19);
    log.tau.col(d) = 0.3 * MultiSine{}.at(log.t_s, 2, 2.1 * d);
    for (Eigen::Index i = 0; i < 10000; ++i) log.tau(i, d) += normal(random);
  }
  for (long i = 0; i < 10000; ++i) log.line.push_back(i + 2);
  return log;
}

void remove_rows(Log& log, Eigen::Index from, Eigen::Index count) {
  std::vector<Eigen::Index> rows;
  std::vector<long> lines;
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    if (i >= from && i < from + count) continue;
    rows.push_back(i);
    lines.push_back(log.line[static_cast<std::size_t>(i)]);
  }
  log.t_s = Eigen::VectorXd(log.t_s(rows));
  log.q = Eigen::MatrixXd(log.q(rows, Eigen::all));
  log.tau = Eigen::MatrixXd(log.tau(rows, Eigen::all));
  log.line = lines;
}

struct Case {
  const char* name;
  std::function<void(Log&)> spoil;
  std::vector<const char*> message;  ///< of the error or of the note
};

class RefusedLogTest : public ::testing::TestWithParam<Case> {};
class RepairedLogTest : public ::testing::TestWithParam<Case> {};

TEST_P(RefusedLogTest, NamesTheProblemAndItsPlace) {
  Log log = good_log();
  GetParam().spoil(log);
  try {
    check_and_repair(log, delta3());
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    EXPECT_THAT(error.what(), HasSubstr("log.csv"));
    EXPECT_FALSE(error.mend().empty());
    for (const char* part : GetParam().message) EXPECT_THAT(error.what(), HasSubstr(part));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Table, RefusedLogTest,
    ::testing::Values(
        Case{"TooFewSamples",
             [](Log& log) { remove_rows(log, 20, 9980); },
             {"too short: 20 samples", "at least 50 samples and 0.5 s"}},
        Case{"TooShortInTime", [](Log& log) { remove_rows(log, 300, 9700); }, {"too short: 300 samples, 0.299 s"}},
        Case{"TimeNotANumber", [](Log& log) { log.t_s(7) = kNan; }, {"line 9, column t_s"}},
        Case{"MillisecondsAsSeconds",
             [](Log& log) { log.t_s *= 1000.0; },
             {"column t_s", "1 s apart", "time in seconds"}},
        Case{"ManySingleMissingNumbers",
             [](Log& log) {
               for (Eigen::Index i = 10; i < 9900; i += 3) log.tau(i, 0) = kNan;
             },
             {"line 12", "% of the samples"}},
        Case{"DegreesForRadians",
             [](Log& log) { log.q *= 180 / std::numbers::pi; },
             {"column q1_rad", "looks like degrees", "q1_deg"}},
        Case{"StuckInMotion",
             [](Log& log) { log.q.col(2).segment(3100, 400).setConstant(log.q(3100, 2)); },
             {"line 3102, column q3_rad", "stuck encoder"}},
        Case{"StuckFromTheStart",
             [](Log& log) { log.q.col(0).setConstant(0.1); },
             {"line 2, column q1_rad", "stuck encoder"}},
        Case{"StuckToTheEnd",
             [](Log& log) { log.q.col(0).tail(2500).setConstant(log.q(7500, 0)); },
             {"line 7502, column q1_rad", "stuck encoder"}},
        Case{"LostCounts",
             [](Log& log) { log.q.col(1).tail(4000).array() += 0.05; },
             {"column q2_rad", "position jumps"}},
        Case{"NothingMoves", [](Log& log) { log.q.setConstant(0.3); }, {"nothing moves"}},
        Case{"TorqueCutOff",
             [](Log& log) { log.tau = log.tau.cwiseMin(2.0).cwiseMax(-2.0).eval(); },
             {"column tau1_Nm", "cut off"}},
        Case{"TorqueNotRecorded", [](Log& log) { log.tau.col(1).setZero(); }, {"column tau2_Nm", "always 0"}},
        Case{"WrongCount", [](Log& log) { log.tau = Eigen::MatrixXd(log.tau.leftCols(2)); }, {"3 drives"}}),
    [](const auto& information) { return std::string(information.param.name); });

TEST_P(RepairedLogTest, IsEvenAndCloseToTheTruthAndSaysSo) {
  const Log truth = good_log();
  Log log = good_log();
  GetParam().spoil(log);
  check_and_repair(log, delta3());
  ASSERT_EQ(log.samples(), truth.samples());
  EXPECT_LT((log.t_s - truth.t_s).cwiseAbs().maxCoeff(), 2e-5);
  const Eigen::VectorXd steps = log.t_s.tail(9999) - log.t_s.head(9999);
  EXPECT_LT(steps.maxCoeff() - steps.minCoeff(), 1e-9);
  EXPECT_TRUE(log.q.allFinite() && log.tau.allFinite());
  EXPECT_LT((log.q - truth.q).cwiseAbs().maxCoeff(), 1e-4);
  ASSERT_FALSE(log.notes.empty());
  for (const char* part : GetParam().message) EXPECT_THAT(log.notes.front(), HasSubstr(part));
}

// A servo that is switched on while the recorder runs, or a recorder that stands still: all positions hold, then go on
// elsewhere.
TEST(FrozenPositions, OfAllDrivesAreMissingAndSplitTheLog) {
  Log log = good_log();
  for (Eigen::Index k = 0; k < 1000; ++k) log.q.row(k) = log.q.row(0).eval();
  for (Eigen::Index k = 5000; k < 5400; ++k) log.q.row(k) = log.q.row(5000).eval();
  const std::vector<Log> parts = check_and_split(log, delta3());
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_NEAR(parts[0].t_s(0), good_log().t_s(1000), 1e-9);
  EXPECT_NEAR(parts[1].t_s(0), good_log().t_s(5400), 1e-9);
  EXPECT_THAT(parts[0].notes, ::testing::Contains(HasSubstr("positions of all drives stand still")));
}

void duplicate_row(Log& log, Eigen::Index row) {
  const Eigen::Index n = log.samples();
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < n; ++i) {
    rows.push_back(i);
    if (i == row) rows.push_back(i);
  }
  log.t_s = Eigen::VectorXd(log.t_s(rows));
  log.q = Eigen::MatrixXd(log.q(rows, Eigen::all));
  log.tau = Eigen::MatrixXd(log.tau(rows, Eigen::all));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i < log.line.size()) continue;
    log.line.push_back(static_cast<long>(i) + 2);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Table, RepairedLogTest,
    ::testing::Values(
        Case{"LostSamples", [](Log& log) { remove_rows(log, 4000, 2); }, {"line 4004", "2 sample(s) missing"}},
        Case{"MissingPosition", [](Log& log) { log.q(300, 1) = kNan; }, {"line 302, column q2_rad"}},
        Case{"MissingTorque", [](Log& log) { log.tau.row(300).setConstant(kNan); }, {"line 302, column tau1_Nm"}},
        Case{"RowTwice", [](Log& log) { duplicate_row(log, 800); }, {"line 803", "there twice"}},
        Case{"PositionSpike", [](Log& log) { log.q(5000, 0) += 0.5; }, {"line 5002, column q1_rad", "spike"}},
        Case{"TorqueSpike", [](Log& log) { log.tau(5000, 2) = 1000.0; }, {"line 5002, column tau3_Nm", "spike"}},
        Case{"RepeatedTime", [](Log& log) { log.t_s(700) = log.t_s(699); }, {"line 702, column t_s", "stamp is wrong"}},
        Case{"StampAhead", [](Log& log) { log.t_s(700) += 5.0; }, {"column t_s", "stamp is wrong"}},
        Case{"MissingAtTheStart", [](Log& log) { log.tau(0, 2) = kNan; }, {"line 2, column tau3_Nm", "no number"}},
        Case{"FivePercentMissing",
             [](Log& log) {
               for (Eigen::Index i = 10; i < 9000; i += 20) log.tau(i, 0) = kNan;
             },
             {"line 12, column tau1_Nm", "the first of 450"}},
        Case{"LongPositionSpike",
             [](Log& log) { log.q.col(0).segment(5000, 4).array() += 0.5; },
             {"line 5002, column q1_rad", "the first of 4 such samples"}},
        Case{"TorqueBrieflyCutOff",
             [](Log& log) { log.tau.col(0) = log.tau.col(0).cwiseMin(0.97 * log.tau.col(0).maxCoeff()).eval(); },
             {"column tau1_Nm", "cut off"}},
        Case{"JitteredStamps",
             [](Log& log) {
               std::mt19937_64 random(5);
               UniformDistribution jitter(-0.0002, 0.0002);
               for (Eigen::Index i = 0; i < log.samples(); ++i) {
                 const double shift = jitter(random);
                 log.t_s(i) += shift;
                 for (int d = 0; d < 3; ++d) {
                   log.q(i, d) = MultiSine{}.at(Eigen::VectorXd::Constant(1, log.t_s(i)), 0, 2.1 * d)(0);
                 }
               }
             },
             {"column t_s", "jitter"}}),
    [](const auto& information) { return std::string(information.param.name); });

TEST(LogCheck, LeavesAGoodLogAlone) {
  const Log truth = good_log();
  Log log = good_log();
  check_and_repair(log, delta3());
  EXPECT_EQ(log.t_s, truth.t_s);
  EXPECT_EQ(log.q, truth.q);
  EXPECT_EQ(log.tau, truth.tau);
  EXPECT_TRUE(log.notes.empty());
  EXPECT_TRUE(log.filled.empty());
}

TEST(LogCheck, MarksExactlyTheFilledSamples) {
  Log log = good_log();
  remove_rows(log, 4000, 2);
  log.q(300, 1) = kNan;
  check_and_repair(log, delta3());
  for (Eigen::Index i = 0; i < log.samples(); ++i) EXPECT_EQ(log.is_filled(i), i == 300 || i == 4000 || i == 4001) << i;
  EXPECT_EQ(log.line[4000], 0);
  EXPECT_EQ(log.line[4002], 4004);
}

std::vector<Log> parts_of(const Log& log) {
  return check_and_split(log, delta3());
}

const LogFinding* finding(const Log& log, const std::string& key, int drive = -1) {
  for (const LogFinding& one : log.findings) {
    if (one.key == key && one.drive == drive) return &one;
  }
  return nullptr;
}

void expect_only_fine(const Log& log) {
  for (const LogFinding& one : log.findings) EXPECT_EQ(one.level, FindingLevel::fine) << one.key << ": " << one.text;
  EXPECT_TRUE(log.notes.empty());
}

TEST(LogCheck, SplitsAtALongGap) {
  const Log truth = good_log();
  Log log = good_log();
  remove_rows(log, 4000, 50);
  const std::vector<Log> parts = parts_of(log);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].part, 1);
  EXPECT_EQ(parts[1].part, 2);
  EXPECT_EQ(parts[1].file, "log.csv");
  EXPECT_EQ(parts[0].q, truth.q.topRows(4000));
  EXPECT_EQ(parts[1].q, truth.q.bottomRows(5950));
  EXPECT_EQ(parts[1].line.front(), 4052);
  ASSERT_EQ(parts[0].notes.size(), 1U);
  EXPECT_THAT(parts[0].notes.front(), HasSubstr("line 4052, column t_s: a gap of 0.051 s"));
  EXPECT_THROW(check_and_repair(log, delta3()), Error);
}

// What was said of a part that is not used stays, in as many words as before: one sentence for the numbers that two
// drives miss.
TEST(LogCheck, AnUnusablePartIsSaidAndKeepsItsWords) {
  Log log = good_log();
  log.tau(1000, 0) = log.tau(1500, 1) = kNan;
  log.tau.col(2).head(4000).setConstant(5);  // while the drive moves
  remove_rows(log, 4000, 50);
  const std::vector<Log> parts = parts_of(log);
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].line.front(), 4052);
  ASSERT_NE(finding(parts[0], "unusable_part"), nullptr);
  EXPECT_FALSE(finding(parts[0], "unusable_part")->mend.empty()) << "a warning names the next step";
  EXPECT_NE(finding(parts[0], "missing_numbers", 0), nullptr);
  EXPECT_NE(finding(parts[0], "missing_numbers", 1), nullptr);
  EXPECT_THAT(parts[0].notes,
              UnorderedElementsAre(HasSubstr("a gap of 0.051 s"), HasSubstr("column tau1_Nm: no number, filled in"),
                                   HasSubstr("column tau2_Nm: no number, filled in"), HasSubstr("part 1 is not used")));
}

TEST(LogCheck, SaysManyGapsOnceAndDropsWhatIsTooShort) {
  Log log = good_log();
  for (const Eigen::Index from : {8000, 5000, 4900}) remove_rows(log, from, 40);
  const std::vector<Log> parts = parts_of(log);
  ASSERT_EQ(parts.size(), 3U);  // the part of 60 rows is none
  EXPECT_EQ(parts[0].notes.size(), 2U);
  ASSERT_NE(finding(parts[0], "gaps"), nullptr);
  EXPECT_EQ(finding(parts[0], "gaps")->value, 3);
  ASSERT_NE(finding(parts[0], "short_parts"), nullptr);
  EXPECT_FALSE(finding(parts[0], "short_parts")->mend.empty()) << "a warning names the next step";
  ASSERT_NE(finding(parts[0], "short_parts"), nullptr);
}

TEST(LogCheck, SplitsWhereAPositionHasNoNumbers) {
  Log log = good_log();
  log.q.col(1).segment(600, 9).setConstant(kNan);
  log.q.row(0).setConstant(kNan);
  const std::vector<Log> parts = parts_of(log);
  ASSERT_EQ(parts.size(), 1U);  // the first 0.6 s are too short beside the rest
  EXPECT_EQ(parts[0].line.front(), 611);
}

TEST(LogCheck, KeepsPositionsWhereOnlyATorqueIsMissing) {
  Log log = good_log();
  log.tau.col(1).segment(600, 300).setConstant(kNan);
  const std::vector<Log> parts = parts_of(log);
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].samples(), 10000);
  ASSERT_GT(parts[0].torque_out.size(), 0);
  EXPECT_TRUE(parts[0].torque_out(700, 1));
  EXPECT_FALSE(parts[0].torque_out(700, 0));
  EXPECT_FALSE(parts[0].torque_out(1000, 1));
}

TEST(LogCheck, TakesTwoRecordingsInOneFileApart) {
  Log log = good_log();
  log.t_s.tail(5000).array() -= 3.0;
  const std::vector<Log> parts = parts_of(log);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_NEAR(parts[1].t_s(0), 2.0, 1e-9);
  EXPECT_THAT(parts[0].notes.front(),
              HasSubstr("line 5002, column t_s: the time stamps decrease, from 4.999 s to 2 s"));
}

TEST(LogCheck, BridgesLostRowsWithinTheNoise) {
  const Log truth = good_log();
  for (const double share : {0.005, 0.05}) {
    Log log = good_log();
    std::mt19937_64 random(3);
    std::vector<Eigen::Index> rows;
    for (Eigen::Index i = 9998; i > 0; --i) {
      if (canonical(random) < share) remove_rows(log, i, 1);
    }
    const std::vector<Log> parts = parts_of(log);
    ASSERT_EQ(parts.size(), 1U);
    const Log& mended = parts.front();
    ASSERT_EQ(mended.samples(), 10000);
    EXPECT_EQ(mended.notes.size(), 1U);
    EXPECT_LT((mended.q - truth.q).cwiseAbs().maxCoeff(), 1e-4);
    Eigen::Index bridged = 0;
    for (Eigen::Index i = 0; i < 10000; ++i) {
      EXPECT_FALSE(mended.is_left_out(i));
      bridged += mended.is_filled(i) ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(bridged), 10000 * share, 400 * share + 20);
  }
}

TEST(LogCheck, TakesHeldRowsAsMissing) {
  const Log truth = good_log();
  Log log = good_log();
  std::mt19937_64 random(8);
  Eigen::Index held = 0;
  for (Eigen::Index i = 1; i < 10000; ++i) {
    if (canonical(random) > 0.01) continue;
    log.q.row(i) = log.q.row(i - 1);
    log.tau.row(i) = log.tau.row(i - 1);
    ++held;
  }
  const Log mended = parts_of(log).front();
  ASSERT_NE(finding(mended, "held_rows"), nullptr);
  EXPECT_EQ(finding(mended, "held_rows")->value, static_cast<double>(held));
  EXPECT_EQ(mended.notes.size(), 1U);
  EXPECT_LT((mended.q - truth.q).cwiseAbs().maxCoeff(), 5e-5);
}

TEST(LogCheck, BringsAStaleLogToItsOwnRate) {
  const Log truth = good_log();
  Log log = good_log();
  for (Eigen::Index i = 0; i < 10000; ++i) log.q.row(i) = truth.q.row(i / 4 * 4);
  const Log mended = parts_of(log).front();
  for (int d = 0; d < 3; ++d) {
    ASSERT_NE(finding(mended, "stale", d), nullptr);
    EXPECT_NEAR(finding(mended, "stale", d)->value, 4.0, 0.05);
    const double travel = finding(parts_of(truth).front(), "travel", d)->value;
    EXPECT_NEAR(finding(mended, "travel", d)->value, travel, 0.01 * travel);
  }
  EXPECT_NEAR(mended.sample_time_s(), 0.004, 1e-9);
  for (Eigen::Index k = 0; k < mended.samples(); ++k) {
    const auto row = static_cast<Eigen::Index>(std::lround(mended.t_s(k) / 0.001));
    ASSERT_EQ(row % 4, 0);
    EXPECT_LT((mended.q.row(k) - truth.q.row(row)).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(LogCheck, SeesASingleStaleDriveAndAStaleTorque) {
  const Log truth = good_log();
  Log one = good_log();
  for (Eigen::Index i = 0; i < 10000; ++i) one.q(i, 1) = truth.q(i / 3 * 3, 1);
  EXPECT_NE(finding(parts_of(one).front(), "stale", 1), nullptr);
  EXPECT_EQ(finding(parts_of(one).front(), "stale", 0)->level, FindingLevel::fine);
  Log torque = good_log();
  for (Eigen::Index i = 0; i < 10000; ++i) torque.tau.row(i) = truth.tau.row(i / 5 * 5);
  EXPECT_NE(finding(parts_of(torque).front(), "stale_torque", 2), nullptr);
}

TEST(LogCheck, LeavesAServoOutThatIsOff) {
  Log log = good_log();
  log.tau.topRows(1000).setZero();
  const Log mended = parts_of(log).front();
  ASSERT_EQ(mended.notes.size(), 1U);
  EXPECT_THAT(mended.notes.front(), HasSubstr("the servo is off"));
  EXPECT_TRUE(mended.torque_out.topRows(1000).all());
  EXPECT_FALSE(mended.torque_out.bottomRows(9000).any());
}

TEST(LogCheck, UnwrapsACounterThatRanOver) {
  const Log truth = good_log();
  Log log = good_log();
  const double turn = 2.0 * std::numbers::pi;
  // A drive whose zero is such that it runs over in the middle of its range.
  for (Eigen::Index i = 0; i < 10000; ++i)
    log.q(i, 2) = std::remainder(truth.q(i, 2) - 0.1 + 0.5 * turn, turn) - 0.5 * turn;
  for (Eigen::Index i = 0; i < 10000; ++i) log.q(i, 2) = log.q(i, 2) < -turn ? log.q(i, 2) + turn : log.q(i, 2);
  const Log mended = parts_of(log).front();
  ASSERT_NE(finding(mended, "wrap", 2), nullptr);
  const Eigen::VectorXd offset = mended.q.col(2) - truth.q.col(2);
  EXPECT_LT(offset.maxCoeff() - offset.minCoeff(), 1e-6);
}

TEST(LogCheck, FindsTheRangeOfACounterThatIsNoTurn) {
  const Log truth = good_log();
  Log log = good_log();
  constexpr double kRange = 0.6;
  for (Eigen::Index i = 0; i < 10000; ++i) log.q(i, 0) = std::remainder(truth.q(i, 0), kRange);
  const Log mended = parts_of(log).front();
  ASSERT_NE(finding(mended, "wrap", 0), nullptr);
  EXPECT_NEAR(finding(mended, "wrap", 0)->value, kRange, 1e-4);
  const Eigen::VectorXd offset = mended.q.col(0) - truth.q.col(0);
  EXPECT_LT(offset.maxCoeff() - offset.minCoeff(), 1e-3);
}

TEST(LogCheck, TakesStampsOfAnOperatingSystemAsEven) {
  const Log truth = good_log();
  Log log = good_log();
  std::mt19937_64 random(5);
  NormalDistribution jitter(0.0, 5e-5);
  for (Eigen::Index i = 0; i < 10000; ++i) log.t_s(i) += std::clamp(jitter(random), -1.5e-4, 1.5e-4);
  const Log mended = parts_of(log).front();
  EXPECT_EQ(mended.q, truth.q);  // not interpolated
  EXPECT_NEAR(mended.sample_time_s(), 0.001, 1e-7);
  EXPECT_EQ(mended.notes.size(), 1U);
}

TEST(LogCheck, MovesSamplesTakenAtUnevenTimes) {
  Log log = good_log();
  double t = 0;
  for (Eigen::Index i = 0; i < 10000; ++i) {
    log.t_s(i) = t;
    t += i % 2 == 0 ? 0.001 : 0.0012;
  }
  const auto exact = [](double when, int d) {
    return MultiSine{}.at(Eigen::VectorXd::Constant(1, when), 0, 2.1 * d)(0);
  };
  for (Eigen::Index i = 0; i < 10000; ++i) {
    for (int d = 0; d < 3; ++d) log.q(i, d) = exact(log.t_s(i), d);
  }
  const Log mended = parts_of(log).front();
  EXPECT_NEAR(mended.sample_time_s(), 0.0011, 1e-6);
  for (Eigen::Index k = 0; k < mended.samples(); k += 97) EXPECT_NEAR(mended.q(k, 1), exact(mended.t_s(k), 1), 1e-6);
}

TEST(LogCheck, TakesAClockTooCoarseForTheRate) {
  const Log truth = good_log();
  Log log = good_log();
  for (Eigen::Index i = 0; i < 10000; ++i) log.t_s(i) = std::floor(log.t_s(i) * 100.0 + 1e-6) / 100.0;
  const Log mended = parts_of(log).front();
  EXPECT_EQ(mended.q, truth.q);
  EXPECT_NEAR(mended.sample_time_s(), 0.001, 2e-6);
}

TEST(LogCheck, LeavesRestOutAndIsNotAlarmed) {
  for (const int bits : {13, 24}) {
    Log log = good_log();
    // Moves and stops in turn, as when things are picked and placed.
    for (Eigen::Index i = 0; i < 10000; ++i) {
      const double t = log.t_s(i);
      const double phase = std::min(std::fmod(t, 1.0) / 0.6, 1.0);
      const double move = phase - std::sin(2.0 * std::numbers::pi * phase) / (2.0 * std::numbers::pi);
      const bool back = std::fmod(t, 2.0) >= 1.0;
      for (int d = 0; d < 3; ++d) log.q(i, d) = (0.4 + 0.1 * d) * (back ? 1.0 - move : move);
    }
    for (int d = 0; d < 3; ++d) log.q.col(d) = quantised(log.q.col(d), bits);
    const Log checked = parts_of(log).front();
    expect_only_fine(checked);
    ASSERT_GT(checked.torque_out.size(), 0);
    EXPECT_TRUE(checked.torque_out(800, 1));
    EXPECT_FALSE(checked.torque_out(300, 1));
    EXPECT_NEAR(finding(checked, "standstill")->value, 0.42, 0.08);
  }
}

TEST(LogCheck, MeasuresWhatIsInOrder) {
  const Log log = parts_of(good_log()).front();
  expect_only_fine(log);
  EXPECT_NEAR(finding(log, "rate_hz")->value, 1000.0, 1e-3);
  EXPECT_NEAR(finding(log, "step", 0)->value, 2.0 * std::numbers::pi / 524288, 1e-7);
  EXPECT_NEAR(finding(log, "torque_noise", 1)->value, 0.1, 0.01);
  EXPECT_EQ(finding(log, "torque_step", 1)->value, 0.0);
  EXPECT_EQ(finding(log, "lost_rows")->value, 0.0);
  EXPECT_EQ(finding(log, "held_rows")->value, 0.0);
  EXPECT_EQ(finding(log, "stale", 2)->value, 1.0);
  EXPECT_GT(finding(log, "travel", 2)->value, 0.1);
}

TEST(LogCheck, AcceptsAHoldAfterASmoothStop) {
  Log log = good_log();
  // A smooth step, then all drives rest: an encoder without noise is then constant, and rightly so.
  for (Eigen::Index i = 0; i < 10000; ++i) {
    const double t = log.t_s(i);
    const double phase = t < 5.0 ? t / 5.0 : 1.0;
    for (int d = 0; d < 3; ++d) log.q(i, d) = (0.2 + 0.1 * d) * (1.0 - std::cos(std::numbers::pi * phase));
  }
  log.q = Eigen::MatrixXd(log.q);
  for (int d = 0; d < 3; ++d) log.q.col(d) = quantised(log.q.col(d), 19);
  EXPECT_NO_THROW(check_and_repair(log, delta3()));
}

TEST(LogCheck, TakesATableOfPosesWithoutTime) {
  Log log;
  log.file = "poses.csv";
  log.t_s = Eigen::VectorXd::Zero(4);
  log.q = Eigen::MatrixXd::Random(4, 3);
  log.tau = Eigen::MatrixXd::Random(4, 3);
  LogCheckOptions options;
  options.motion = false;
  EXPECT_NO_THROW(check_and_repair(log, delta3(), options));
  log.q(2, 1) = 30.0;
  EXPECT_THROW(check_and_repair(log, delta3(), options), Error);
  log.q(2, 1) = kNan;
  EXPECT_THROW(check_and_repair(log, delta3(), options), Error);
}

TEST(LogCheck, SeesThatVelocitiesFarBeyondTheLimitAreAnotherUnit) {
  RobotDescription axis;
  axis.type = "axis";
  axis.limbs.resize(1);
  axis.limits.resize(1);
  axis.limits[0].velocity = 6.0;
  Log log = good_log();
  log.q = Eigen::MatrixXd(log.q.leftCols(1));
  log.tau = Eigen::MatrixXd(log.tau.leftCols(1));
  EXPECT_NO_THROW(check_and_repair(log, axis));
  log.q *= 180 / std::numbers::pi;
  EXPECT_THROW(check_and_repair(log, axis), Error);
}

}  // namespace
}  // namespace deltadyn
