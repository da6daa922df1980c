#include "deltadyn/report/log_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deltadyn/runtime/robot.hpp"

#include "identification/synthetic_log.hpp"

namespace deltadyn {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

LogFinding finding(FindingLevel level, const std::string& key, const std::string& text) {
  LogFinding f;
  f.level = level;
  f.key = key;
  f.text = text;
  return f;
}

TEST(LogReport, VerdictAndWordsAgree) {
  const LogFinding fault = finding(FindingLevel::fault, "unexplained", "x"),
                   warning = finding(FindingLevel::warning, "delay", "y"),
                   mended = finding(FindingLevel::mended, "gaps", "z"), fine = finding(FindingLevel::fine, "step", "w");
  EXPECT_EQ(check_verdict_in_words({fine}), "no fault was found");
  EXPECT_EQ(check_verdict_in_words({fine, mended}), "no fault was found, 1 finding mended");
  EXPECT_EQ(check_verdict_in_words({warning, warning, mended}),
            "these logs can be used with care: no fault was found, 2 warnings, 1 finding mended");
  EXPECT_EQ(check_verdict_in_words({fault, warning}),
            "a model from these logs is not to be trusted: 1 fault, 1 warning");
  EXPECT_EQ(verdict_of({fault, warning}), Verdict::bad);
}

TEST(LogReport, ShowsDelaysInMillisecondsAndChannelsInATable) {
  const auto robot = make_robot(testing_support::delta_description("delta3"));
  LogFinding delay = finding(FindingLevel::mended, "delay", "torque is late");
  delay.value = 2e-3;
  delay.std = 3e-5;
  delay.unit = "s";
  LogFinding step = finding(FindingLevel::fine, "step", "q1_rad is quantised to 0.1 rad");
  step.file = "a.csv";
  Log log;
  log.file = "a.csv";
  log.t_s = Eigen::VectorXd::LinSpaced(11, 0.0, 1.0);
  log.q = log.tau = Eigen::MatrixXd::Zero(11, 3);
  const std::string page = log_report(*robot, {log}, {"r.urdf", {"a.csv"}, "", "delta-log check", {delay, step}});
  EXPECT_THAT(page, HasSubstr("2.000 ± 0.030 ms"));
  EXPECT_THAT(page, HasSubstr("position step"));
  EXPECT_THAT(page, Not(HasSubstr("q1_rad is quantised")));
}

}  // namespace
}  // namespace deltadyn
