#include "deltadyn/signal/log_check.hpp"

#include <functional>
#include <gmock/gmock.h>
#include <limits>
#include <random>

#include "deltadyn/runtime/error.hpp"

#include "signal/multi_sine.hpp"

namespace deltadyn {
namespace {

using namespace deltadyn::testing;
using ::testing::HasSubstr;

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
  std::normal_distribution<double> normal(0.0, 0.1);
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
        Case{"DecreasingTime",
             [](Log& log) { log.t_s.tail(5000).array() -= 3.0; },
             {"line 5002, column t_s", "decrease, from 4.999 s to 2 s"}},
        Case{"RepeatedTime", [](Log& log) { log.t_s(700) = log.t_s(699); }, {"line 702, column t_s", "0.699 s is repeated"}},
        Case{"TimeNotANumber", [](Log& log) { log.t_s(7) = kNan; }, {"line 9, column t_s"}},
        Case{"LongGap", [](Log& log) { remove_rows(log, 4000, 50); }, {"line 4052, column t_s", "gap of 0.051 s", "cut the log"}},
        Case{"UnevenTime",
             [](Log& log) {
               std::mt19937_64 random(5);
               std::uniform_real_distribution<double> step(0.0002, 0.0018);
               for (Eigen::Index i = 1; i < log.samples(); ++i) log.t_s(i) = log.t_s(i - 1) + step(random);
             },
             {"column t_s", "uneven"}},
        Case{"MillisecondsAsSeconds", [](Log& log) { log.t_s *= 1000.0; }, {"column t_s", "1 s apart", "time in seconds"}},
        Case{"ManyMissingNumbers",
             [](Log& log) { log.q.col(1).segment(600, 9).setConstant(kNan); },
             {"line 602, column q2_rad", "9 samples"}},
        Case{"MissingAtTheStart", [](Log& log) { log.tau(0, 2) = kNan; }, {"line 2, column tau3_Nm", "very start"}},
        Case{"ManySingleMissingNumbers",
             [](Log& log) {
               for (Eigen::Index i = 10; i < 9000; i += 20) log.tau(i, 0) = kNan;
             },
             {"line 12", "% of the samples"}},
        Case{"DegreesForRadians",
             [](Log& log) { log.q *= 180 / std::numbers::pi; },
             {"column q1_rad", "looks like degrees", "q1_deg"}},
        Case{"StuckInMotion",
             [](Log& log) { log.q.col(2).segment(3100, 400).setConstant(log.q(3100, 2)); },
             {"line 3102, column q3_rad", "stuck encoder"}},
        Case{"StuckFromTheStart", [](Log& log) { log.q.col(0).setConstant(0.1); }, {"line 2, column q1_rad", "stuck encoder"}},
        Case{"StuckToTheEnd",
             [](Log& log) { log.q.col(0).tail(2500).setConstant(log.q(7500, 0)); },
             {"line 7502, column q1_rad", "stuck encoder"}},
        Case{"LostCounts", [](Log& log) { log.q.col(1).tail(4000).array() += 0.05; }, {"column q2_rad", "position jumps"}},
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
  const LogFindings findings = check_and_repair(log, delta3());
  ASSERT_EQ(log.samples(), truth.samples());
  EXPECT_LT((log.t_s - truth.t_s).cwiseAbs().maxCoeff(), 2e-5);
  const Eigen::VectorXd steps = log.t_s.tail(9999) - log.t_s.head(9999);
  EXPECT_LT(steps.maxCoeff() - steps.minCoeff(), 1e-9);
  EXPECT_TRUE(log.q.allFinite() && log.tau.allFinite());
  EXPECT_LT((log.q - truth.q).cwiseAbs().maxCoeff(), 1e-4);
  ASSERT_FALSE(findings.notes.empty());
  EXPECT_EQ(log.notes, findings.notes);
  for (const char* part : GetParam().message) EXPECT_THAT(log.notes.front(), HasSubstr(part));
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
    ::testing::Values(Case{"LostSamples", [](Log& log) { remove_rows(log, 4000, 2); }, {"line 4004", "2 sample(s) missing"}},
                      Case{"MissingPosition", [](Log& log) { log.q(300, 1) = kNan; }, {"line 302, column q2_rad"}},
                      Case{"MissingTorque", [](Log& log) { log.tau.row(300).setConstant(kNan); }, {"line 302, column tau1_Nm"}},
                      Case{"RowTwice", [](Log& log) { duplicate_row(log, 800); }, {"line 803", "there twice"}},
                      Case{"PositionSpike", [](Log& log) { log.q(5000, 0) += 0.5; }, {"line 5002, column q1_rad", "spike"}},
                      Case{"TorqueSpike", [](Log& log) { log.tau(5000, 2) = 1000.0; }, {"line 5002, column tau3_Nm", "spike"}},
                      Case{"TorqueBrieflyCutOff",
                           [](Log& log) { log.tau.col(0) = log.tau.col(0).cwiseMin(0.97 * log.tau.col(0).maxCoeff()).eval(); },
                           {"column tau1_Nm", "cut off"}},
                      Case{"JitteredStamps",
                           [](Log& log) {
                             std::mt19937_64 random(5);
                             std::uniform_real_distribution<double> jitter(-0.0002, 0.0002);
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
  const LogFindings findings = check_and_repair(log, delta3());
  EXPECT_EQ(log.t_s, truth.t_s);
  EXPECT_EQ(log.q, truth.q);
  EXPECT_EQ(log.tau, truth.tau);
  EXPECT_TRUE(log.notes.empty());
  EXPECT_EQ(findings.filled_samples, 0);
}

TEST(LogCheck, MarksExactlyTheFilledSamples) {
  Log log = good_log();
  remove_rows(log, 4000, 2);
  log.q(300, 1) = kNan;
  const LogFindings findings = check_and_repair(log, delta3());
  EXPECT_EQ(findings.filled_samples, 3);
  for (Eigen::Index i = 0; i < log.samples(); ++i) EXPECT_EQ(log.is_filled(i), i == 300 || i == 4000 || i == 4001) << i;
  EXPECT_EQ(log.line[4000], 0);
  EXPECT_EQ(log.line[4002], 4004);
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

TEST(LogCheckOptions, RefusesNonsense) {
  LogCheckOptions options;
  options.max_resampled_jitter = 0.7;
  Log log = good_log();
  EXPECT_THROW(check_and_repair(log, delta3(), options), Error);
}

}  // namespace
}  // namespace deltadyn
