#include "deltadyn/report/log_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "identification/synthetic_log.hpp"

namespace deltadyn {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

void tell(Log& log, const std::string& key, int drive, double value) {
  LogFinding f;
  f.key = key;
  f.file = log.file;
  f.drive = drive;
  f.value = value;
  log.findings.push_back(f);
}

Log log_of(const std::string& file, int part, Eigen::Index rows) {
  Log log;
  log.file = file;
  log.part = part;
  log.t_s = Eigen::VectorXd::LinSpaced(rows, 0.0, 0.001 * static_cast<double>(rows - 1));
  log.q = log.tau = Eigen::MatrixXd::Zero(rows, 3);
  tell(log, "rate_hz", -1, 1000);
  return log;
}

TEST(LogTable, HasALineADriveAndOneForTheTiming) {
  Log log = log_of("fast.csv", 0, 1001);
  for (int j = 0; j < 3; ++j) {
    tell(log, "travel", j, 0.9049);
    tell(log, "step", j, j == 2 ? 0.0 : 1.2e-5);
    tell(log, "torque_step", j, 0.0);
    tell(log, "torque_noise", j, 0.1);
    tell(log, "stale", j, j == 1 ? 4 : 1);
    tell(log, "moving", j, 0.5);
  }
  const auto robot = testing_support::delta_description("delta3");
  const std::vector<std::string> lines = channel_lines(robot, log_figures({log}).front());
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(lines[0], "fast.csv: 1001 rows, 1 s, recorded at 1000 Hz, time stamps even, no row lost, no row repeated");
  EXPECT_THAT(lines[2], HasSubstr("0.905 rad     1.2e-05 rad"));
  EXPECT_THAT(lines[2], HasSubstr("not visible        0.1 N m"));
  EXPECT_THAT(lines[3], HasSubstr("every 4 rows"));
  EXPECT_THAT(lines[4], HasSubstr("0.905 rad     not visible"));
  EXPECT_THAT(lines[4], HasSubstr("50 %"));
  for (const std::string& line : lines) EXPECT_EQ(line.size() == lines[1].size(), &line != &lines[0]) << line;
}

TEST(LogTable, PartsOfALogAreOneRowOfFigures) {
  std::vector<Log> logs = {log_of("a.csv", 1, 1001), log_of("a.csv", 2, 3001), log_of("b.csv", 0, 501)};
  tell(logs[0], "travel", 0, 0.2);
  tell(logs[1], "travel", 0, 0.6);
  tell(logs[0], "moving", 0, 1.0);
  tell(logs[1], "moving", 0, 0.5);
  tell(logs[0], "lost_rows", -1, 2);
  const std::vector<LogFigures> figures = log_figures(logs);
  ASSERT_EQ(figures.size(), 2U);
  EXPECT_EQ(figures[0].rows, 4002);
  EXPECT_NEAR(figures[0].seconds, 4.0, 1e-9);
  EXPECT_EQ(figures[0].drives[0].travel, 0.6);
  EXPECT_NEAR(figures[0].drives[0].moving, 0.625, 1e-3);
  EXPECT_THAT(timing_in_words(figures[0]), HasSubstr("2 rows lost"));
  EXPECT_THAT(timing_in_words(figures[1]), HasSubstr("no row lost"));
}

TEST(LogTable, SaysUnevenStampsAndUsesTheUnitsOfTheDrives) {
  Log log = log_of("a.csv", 0, 1001);
  tell(log, "jitter", -1, 0.02);
  tell(log, "travel", 0, 0.25);
  const auto linear = testing_support::delta_description("linear-delta3");
  EXPECT_THAT(timing_in_words(log_figures({log}).front()), HasSubstr("even to 2 % of the time between rows"));
  EXPECT_THAT(channel_lines(linear, log_figures({log}).front())[2], HasSubstr("0.25 m"));
}

}  // namespace
}  // namespace deltadyn
