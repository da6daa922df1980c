#include "deltadyn/io/log_file.hpp"

#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <numbers>

#include "deltadyn/runtime/error.hpp"

#include "io/temporary_folder.hpp"

namespace deltadyn {
namespace {

using ::deltadyn::testing_support::TemporaryFolder;
using ::testing::HasSubstr;

RobotDescription axis(DriveKind kind) {
  RobotDescription robot;
  robot.type = "axis";
  robot.drive_kind = kind;
  robot.limbs.resize(1);
  robot.limits.resize(1);
  return robot;
}

std::string log_text(const std::string& header, int rows, double position_scale) {
  std::string text = header + "\n";
  for (int i = 0; i < rows; ++i) {
    const double t = 0.001 * i;
    text += fmt::format("{:.3f},{},{}\n", t, position_scale * std::sin(7 * t), 3.0 * std::cos(5 * t));
  }
  return text;
}

TEST(LogFile, WritesAndReadsBackExactly) {
  const TemporaryFolder folder;
  const RobotDescription robot = axis(DriveKind::prismatic);
  Log log;
  log.t_s = Eigen::VectorXd::LinSpaced(1000, 0, 0.999);
  log.q = (7.0 * log.t_s.array()).sin();
  log.qd = 7.0 * (7.0 * log.t_s.array()).cos();
  log.tau = (5.0 * log.t_s.array()).cos();
  write_log(folder.path("log.csv"), log, robot);
  EXPECT_EQ(folder.read("log.csv").substr(0, 20), "t_s,q1_m,qd1_m_s,tau");
  const Log back = read_log(folder.path("log.csv"), robot);
  EXPECT_EQ(back.t_s, log.t_s);
  EXPECT_EQ(back.q, log.q);
  EXPECT_EQ(back.qd, log.qd);
  EXPECT_EQ(back.qdd.size(), 0);
  EXPECT_EQ(back.tau, log.tau);
  EXPECT_EQ(back.line.at(5), 7);
  EXPECT_TRUE(back.notes.empty());
}

TEST(LogFile, ConvertsDegreesAndTurnsPerMinute) {
  const TemporaryFolder folder;
  std::string text = "other,qd1_rpm,tau1_Nm,q1_deg,qdd1_deg_s2,t_s\n";
  for (int i = 0; i < 600; ++i) text += fmt::format("x,30,{},{},90,{}\n", i % 7, 0.18 * i, 0.001 * i);
  const Log log = read_log(folder.write("log.csv", text), axis(DriveKind::revolute));
  EXPECT_NEAR(log.qd(3, 0), std::numbers::pi, 1e-15);
  EXPECT_NEAR(log.qdd(3, 0), std::numbers::pi / 2, 1e-15);
  EXPECT_NEAR(log.q(500, 0), std::numbers::pi / 2, 1e-15);
}

struct BadLog {
  const char* name;
  DriveKind kind;
  std::string header;
  bool derivatives;  ///< needed, too
  std::vector<const char*> message;
};

class BadLogHeaderTest : public ::testing::TestWithParam<BadLog> {};

TEST_P(BadLogHeaderTest, SaysWhatIsMissingAndWhatIsThere) {
  const TemporaryFolder folder;
  LogReadOptions options;
  options.need_derivatives = GetParam().derivatives;
  try {
    (void)read_log(folder.write("log.csv", log_text(GetParam().header, 1000, 1.0)), axis(GetParam().kind), options);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    EXPECT_THAT(error.what(), HasSubstr("log.csv"));
    for (const char* part : GetParam().message) EXPECT_THAT(error.what(), HasSubstr(part));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadLogHeaderTest,
    ::testing::Values(
        BadLog{"PrismaticForRevolute",
               DriveKind::revolute,
               "t_s,q1_m,tau1_N",
               false,
               {"q1_rad is missing", "q1_m", "prismatic drive"}},
        BadLog{"RevoluteForPrismatic",
               DriveKind::prismatic,
               "t_s,q1_deg,tau1_N",
               false,
               {"q1_m is missing", "q1_deg", "revolute"}},
        BadLog{"OtherSpelling",
               DriveKind::revolute,
               "t_s,Q_1,tau1_Nm",
               false,
               {"q1_rad is missing", "has Q_1", "q1_rad or q1_deg"}},
        BadLog{"OtherNumber",
               DriveKind::revolute,
               "t_s,q10_rad,tau1_Nm",
               false,
               {"q1_rad is missing", "t_s, q10_rad, tau1_Nm"}},
        BadLog{"NoTorque", DriveKind::revolute, "t_s,q1_rad,x", false, {"tau1_Nm is missing"}},
        BadLog{
            "NoTime", DriveKind::revolute, "x,q1_rad,tau1_Nm", false, {"t_s is missing", "has x, q1_rad", "--rate-hz"}},
        BadLog{"NoRates", DriveKind::revolute, "t_s,q1_rad,tau1_Nm", true, {"qd1_rad_s is missing"}}),
    [](const auto& information) { return std::string(information.param.name); });

TEST(LogFile, SaysWhichJointsOfALongerArmAreNotUsed) {
  const TemporaryFolder folder;
  std::string text = "t_s,q1_rad,q2_rad,q3_rad\n";
  for (int k = 0; k < 20; ++k) text += fmt::format("{},1,2,3\n", 0.001 * k);
  LogReadOptions options;
  options.check = options.need_torque = false;
  const Log log = read_log(folder.write("arm.csv", text), axis(DriveKind::revolute), options);
  ASSERT_EQ(log.notes.size(), 1U);
  EXPECT_THAT(log.notes[0], HasSubstr("has 1 drive, so q1 was taken; q2_rad, q3_rad are not used"));
}

TEST(LogFile, TorqueMayBeMissingIfNotNeeded) {
  const TemporaryFolder folder;
  LogReadOptions options;
  options.need_torque = false;
  const Log log =
      read_log(folder.write("log.csv", log_text("t_s,q1_rad,x", 1000, 1.0)), axis(DriveKind::revolute), options);
  EXPECT_EQ(log.tau.size(), 0);
  EXPECT_EQ(log.samples(), 1000);
}

TEST(LogFile, FillsAMissingNumberAndSaysWhere) {
  const TemporaryFolder folder;
  std::string text = "t_s,q1_rad,tau1_Nm\n";
  for (int i = 0; i < 1000; ++i) {
    const std::string q = i == 500 ? "" : fmt::format("{}", std::sin(0.007 * i));
    text += fmt::format("{:.3f},{},{}\n", 0.001 * i, q, std::cos(0.005 * i));
  }
  const Log log = read_log(folder.write("log.csv", text), axis(DriveKind::revolute));
  EXPECT_NEAR(log.q(500, 0), std::sin(3.5), 1e-8);
  EXPECT_TRUE(log.is_filled(500));
  ASSERT_EQ(log.notes.size(), 1u);
  EXPECT_THAT(log.notes[0], HasSubstr("line 502, column q1_rad"));
}

}  // namespace
}  // namespace deltadyn
