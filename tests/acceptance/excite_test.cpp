// delta-excite as a user runs it. The target of the main case with the clock as its limit is measured by hand:
//   delta-excite mujoco_delta4.urdf <flags below> --time-limit-s 60 --summary s.csv -o t.csv
// Here the search ends by its starts, so that the figures do not depend on the load of the machine.

#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include "acceptance/tool_run.hpp"
#include "acceptance/workshop.hpp"

namespace deltadyn::acceptance {
namespace {

using ::testing::HasSubstr;

const Words kMainCase = {"--workspace",
                         "half-ball",
                         "--workspace-center-m",
                         "0,0,-0.80",
                         "--workspace-radius-m",
                         "0.35",
                         "--drive-velocity-rad-s",
                         "6,6,6,48",
                         "--drive-acceleration-rad-s2",
                         "60,60,60,240",
                         "--platform-velocity-m-s",
                         "4",
                         "--platform-acceleration-m-s2",
                         "50",
                         "--yaw-velocity-rad-s",
                         "48",
                         "--yaw-acceleration-rad-s2",
                         "240",
                         "--yaw-range-rad",
                         "40",
                         "--base-frequency-hz",
                         "0.1,1",
                         "--torque-scale",
                         "60,60,60,4"};

Words excite(const std::string& robot) {
  return {"delta-excite", installed("robots/" + robot)};
}

TEST(Excite, ReachesTheEfficiencyAndKeepsTheLimits) {
  const testing_support::TemporaryFolder folder;
  succeed(excite("mujoco_delta4.urdf") + kMainCase +
              Words{"-o", folder.path("t.csv"), "--coefficients", folder.path("c.csv"), "--summary",
                    folder.path("s.csv"), "--starts", "16", "--time-limit-s", "500"},
          {600});
  const auto summary = read_summary(folder.path("s.csv"));
  EXPECT_EQ(summary.at("stopped"), "completed");
  EXPECT_EQ(summary.at("base_parameters"), "37");
  EXPECT_THAT(summary.at("binding_limits"), HasSubstr("; "));
  figure("d_efficiency_missing_to_one", 1 - number(summary, "d_efficiency"), 1 - 0.65);
  figure("constraint_violation", -number(summary, "constraint_margin"), 0);
  EXPECT_LT(number(summary, "bound_gap"), 1.1e-3);

  const Lines lines = to_lines(folder.read("t.csv"));
  EXPECT_EQ(lines[0],
            "t_s,x_m,y_m,z_m,psi_rad,xd_m_s,yd_m_s,zd_m_s,psid_rad_s,xdd_m_s2,ydd_m_s2,zdd_m_s2,psidd_rad_s2,"
            "q1_rad,q2_rad,q3_rad,q4_rad,qd1_rad_s,qd2_rad_s,qd3_rad_s,qd4_rad_s,qdd1_rad_s2,qdd2_rad_s2,qdd3_rad_s2,"
            "qdd4_rad_s2");
  EXPECT_EQ(static_cast<double>(lines.size() - 1), number(summary, "samples"));
  EXPECT_GT(lines.size(), 10000U);
  const double limit[] = {0,   0,   0,   0,  40, 4, 4, 4,  48, 50, 50, 50, 240,
                          1.6, 1.6, 1.6, 50, 6,  6, 6, 48, 60, 60, 60, 240};
  for (std::size_t k = 2; k <= lines.size(); ++k) {
    for (std::size_t c = 4; c < 25; ++c)
      ASSERT_LE(std::abs(field(lines, k, c)), limit[c]) << "line " << k << ", column " << c;
    const double x = field(lines, k, 1), y = field(lines, k, 2), z = field(lines, k, 3) + 0.8;
    ASSERT_LE(x * x + y * y + z * z, 0.35 * 0.35);
    ASSERT_LE(z, 0);
  }
  for (const std::size_t end : {std::size_t{2}, lines.size()}) {
    for (std::size_t c = 17; c < 25; ++c) EXPECT_NEAR(field(lines, end, c), 0, 1e-6) << "at rest, column " << c;
  }
}

// Everything that is seen of a plan is one judgement: the word of the summary and the line on the terminal.
TEST(Excite, SlowAndFastSegmentsHaveFilesOfTheirOwnAndRowsAwayFromReversals) {
  const testing_support::TemporaryFolder folder;
  const ToolResult result =
      run(excite("mujoco_delta4.urdf") + kMainCase +
              Words{"-o", folder.path("t.csv"), "--summary", folder.path("s.csv"), "--segments", "2",
                    "--segment-speeds", "0.3,1", "--segment-files", "--starts", "4", "--time-limit-s", "500"},
          {600});
  EXPECT_EQ(result.code, 0) << result.err;
  const auto summary = read_summary(folder.path("s.csv"));
  EXPECT_THAT(result.out + result.err,
              HasSubstr(summary.at("verdict") == "trusted" ? "A good excitation" : " excitation: "));
  for (const char* segment : {"1", "2"}) {
    for (const char* drive : {"1", "2", "3", "4"})
      EXPECT_GT(number(summary, fmt::format("away_from_reversals_segment{}_drive{}", segment, drive)), 0.43);
  }
  const auto largest = [&](const char* file, std::size_t column) {
    const Lines lines = to_lines(folder.read(file));
    double most = 0;
    for (std::size_t k = 2; k <= lines.size(); ++k) most = std::max(most, std::abs(field(lines, k, column)));
    return most;
  };
  EXPECT_LT(largest("t_1.csv", 18), 0.3 * 6 * 1.001);         // drive 1, velocity
  EXPECT_LT(largest("t_1.csv", 22), 0.3 * 0.3 * 60 * 1.001);  // and acceleration
  EXPECT_GT(largest("t_2.csv", 22), 30);
}

TEST(Excite, APriorThatIsTooLightDoesNotSaturateTheRobot) {
  const testing_support::TemporaryFolder folder;
  const std::string truth = installed("logs/mujoco_delta4/truth.csv");
  const Lines lines = to_lines(read_text(truth));
  std::string light = lines[0] + "\n";
  for (std::size_t k = 2; k <= lines.size(); ++k) {
    const std::string& line = lines[k - 1];
    if (line.find(',') == std::string::npos) continue;  // the last line is empty
    const auto name_end = line.find(','), value_end = line.find(',', name_end + 1);
    light += fmt::format("{},{:.9g}{}\n", line.substr(0, name_end), 0.7 * field(lines, k, 1), line.substr(value_end));
  }
  const std::string light_file = folder.write("light.csv", light);
  succeed(excite("mujoco_delta4.urdf") + kMainCase +
          Words{"-o", folder.path("t.csv"), "--params", light_file, "--drive-torque-n-m", "40,40,40,4", "--starts", "1",
                "--time-limit-s", "60"});
  succeed({"delta-simulate", installed("robots/mujoco_delta4.urdf"), "--params", truth, "--trajectory",
           folder.path("t.csv"), "--encoder-bits", "19", "-o", folder.path("log.csv")});
  const Lines log = to_lines(folder.read("log.csv"));
  double most = 0;
  for (std::size_t k = 2; k <= log.size(); ++k)
    for (std::size_t c = 6; c < 9; ++c) most = std::max(most, std::abs(field(log, k, c)));
  EXPECT_LT(most, 40);
  EXPECT_GT(most, 25) << "a margin that leaves nothing to move with is none";
}

TEST(Excite, SameSeedSameBytesWhateverTheThreads) {
  const testing_support::TemporaryFolder folder;
  const Words flags =
      excite("mujoco_delta4.urdf") + kMainCase + Words{"--starts", "2", "--harmonics", "3", "--time-limit-s", "500"};
  for (const std::string threads : {"1", "3"}) {
    succeed(flags + Words{"--threads", threads, "-o", folder.path("t" + threads), "--coefficients",
                          folder.path("c" + threads), "--validation", folder.path("v" + threads)});
  }
  EXPECT_EQ(folder.read("t1"), folder.read("t3"));
  EXPECT_EQ(folder.read("c1"), folder.read("c3"));
  EXPECT_EQ(folder.read("v1"), folder.read("v3"));
  EXPECT_NE(folder.read("t1"), folder.read("v1"));
  succeed(flags + Words{"--seed", "2", "-o", folder.path("other")});
  EXPECT_NE(folder.read("t1"), folder.read("other"));
}

TEST(Excite, CtrlCGivesTheBestMotionSoFar) {
  const testing_support::TemporaryFolder folder;
  const Words words = excite("mujoco_delta4.urdf") + kMainCase +
                      Words{"-o", folder.path("t.csv"), "--summary", folder.path("s.csv"), "--time-limit-s", "500"};
  const RunningTool tool = start(words, {600});
  wait_for_work(tool, 6);
  ::kill(tool.process, SIGINT);
  const ToolResult result = finish(tool);
  EXPECT_EQ(result.code, 0) << result.out << result.err;
  const auto summary = read_summary(folder.path("s.csv"));
  EXPECT_EQ(summary.at("stopped"), "interrupted");
  EXPECT_GE(number(summary, "constraint_margin"), 0);
  EXPECT_GT(to_lines(folder.read("t.csv")).size(), 1000U);
}

TEST(Excite, ServesEveryRobotWithTheLimitsOfItsFile) {
  const testing_support::TemporaryFolder folder;
  const Words few = {"--starts", "2", "--harmonics", "3", "--time-limit-s", "300"};
  const struct {
    const char* robot;
    Words more;
    const char* columns;
  } cases[] = {
      {"delta3.urdf", {"--segments", "2", "--segment-speeds", "0.3,1"}, "t_s,x_m,y_m,z_m,xd_m_s"},
      {"linear_delta3.urdf", {"--periodic"}, "q1_m,q2_m,q3_m,qd1_m_s"},
      {"irb360_6_1600.urdf",
       {"--workspace", "cylinder", "--workspace-center-m", "0,0,-0.95", "--workspace-radius-m", "0.3",
        "--workspace-height-m", "0.2", "--params", installed("logs/mujoco_delta4/truth.csv"), "--drive-torque-n-m",
        "60,60,60,4"},
       "psi_rad"},
      {"emps.urdf",
       {"--drive-range-m", "0,0.4", "--drive-velocity-m-s", "0.5", "--drive-acceleration-m-s2", "5"},
       "t_s,q1_m,qd1_m_s,qdd1_m_s2"},
  };
  for (const auto& c : cases) {
    succeed(excite(c.robot) + few + c.more +
                Words{"-o", folder.path("t.csv"), "--summary", folder.path("s.csv"), "--report", folder.path("r.html")},
            {300});
    EXPECT_THAT(to_lines(folder.read("t.csv"))[0], HasSubstr(c.columns)) << c.robot;
    EXPECT_GE(number(read_summary(folder.path("s.csv")), "constraint_margin"), 0) << c.robot;
    EXPECT_THAT(folder.read("r.html"), HasSubstr("What the motion will identify"));
  }
}

// Each limit makes sense and slow states that fall inside them exist, but no pose holds itself and its friction with 12
// N m.
TEST(Excite, LimitsThatCannotBeMetAreNamedWithExitCodeFour) {
  const testing_support::TemporaryFolder folder;
  const ToolResult result = run(excite("mujoco_delta4.urdf") + Words{"-o",
                                                                     folder.path("t.csv"),
                                                                     "--workspace",
                                                                     "half-ball",
                                                                     "--workspace-center-m",
                                                                     "0,0,-0.80",
                                                                     "--workspace-radius-m",
                                                                     "0.35",
                                                                     "--params",
                                                                     installed("logs/mujoco_delta4/truth.csv"),
                                                                     "--drive-torque-n-m",
                                                                     "12,12,12,4",
                                                                     "--torque-margin",
                                                                     "0",
                                                                     "--drive-velocity-rad-s",
                                                                     "0.5",
                                                                     "--drive-acceleration-rad-s2",
                                                                     "2",
                                                                     "--time-limit-s",
                                                                     "5",
                                                                     "--report",
                                                                     folder.path("r.html")});
  EXPECT_EQ(result.code, 4) << result.out << result.err;
  EXPECT_THAT(result.err, HasSubstr("no motion keeps all limits"));
  EXPECT_THAT(result.err, HasSubstr("torque' (-1"));
  EXPECT_THAT(result.err, HasSubstr("where -12 to 12 is allowed"));
  EXPECT_THAT(result.err, HasSubstr("mend: widen this limit"));
  EXPECT_FALSE(fs::exists(folder.path("t.csv")));
  EXPECT_FALSE(fs::exists(folder.path("r.html")));
}

// However short the time, the limits hold, and a motion that shows little is not handed out without a word.
TEST(Excite, SaysWhenTheTimeWasTooShort) {
  const testing_support::TemporaryFolder folder;
  const ToolResult result = run(excite("mujoco_delta4.urdf") + kMainCase +
                                Words{"--segments", "2", "--segment-speeds", "0.3,1", "--time-limit-s", "0.01", "-o",
                                      folder.path("t.csv"), "--summary", folder.path("s.csv")});
  if (result.code == 4) {
    EXPECT_THAT(result.err, HasSubstr("--time-limit-s"));
    EXPECT_FALSE(fs::exists(folder.path("t.csv")));
    return;
  }
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("the time was over before segment 1 could be made better"));
  EXPECT_THAT(result.out, HasSubstr("the time was over before segment 2 could be made better"));
  const auto summary = read_summary(folder.path("s.csv"));
  EXPECT_EQ(summary.at("stopped"), "time");
  EXPECT_GE(number(summary, "constraint_margin"), 0);
}

TEST(Excite, BadInputIsNamedAtOnce) {
  const Workshop shop;
  const Words start = {"delta-excite", shop.path("robot.urdf"), "-o", shop.path("t.csv")};
  const struct {
    Words flags;
    int code;
    const char* text;
  } cases[] = {
      {kMainCase + Words{"--drive-range-rad", "0.5,0.4;-1,1;-1,1;-50,50"}, 2, "'0.5,0.4' is not a range"},
      {kMainCase + Words{"--workspace-center-m", "0,0,-3"}, 2, "--workspace-center-m"},
      {{"--workspace", "ball", "--workspace-center-m", "0,0,-3", "--workspace-radius-m", "0.2"},
       3,
       "reaches only 0.0 % of the workspace"},
      {{"--workspace", "ball", "--workspace-center-m", "0,0,-0.9"}, 2, "radius of the workspace"},
      {{"--workspace-radius-m", "0.3"}, 2, "without its shape"},
      {{"--base-frequency-hz", "0.05,1"}, 2, "too low for 10 s: its period lasts 20 s"},
      {{"--base-frequency-hz", "1,0.5"}, 2, "--base-frequency-hz"},
      {{"--workspace", "ball", "--workspace-center-m", "0,0,-0.9", "--workspace-radius-m", "0.2", "--drive-range-rad",
        "-0.9,-0.5;-0.9,-0.5;-0.9,-0.5;-40,40"},
       3,
       "the limits leave no motion"},
      {{"--drive-velocity-rad-s", "0"}, 2, "drive 1 velocity limit is 0"},
      {{"--drive-velocity-rad-s", "1,2"}, 2, "--drive-velocity-rad-s has 2 values"},
      {{"--drive-velocity-m-s", "1"}, 2, "not the unit of the drives"},
      {{"--drive-range-rad", "1.5,1.6;1.5,1.6;1.5,1.6;-1,1"}, 3, "the limits leave no motion"},
      {{"--drive-torque-n-m", "60"}, 2, "needs a model"},
      {{"--params", installed("logs/mujoco_delta4/truth.csv"), "--drive-torque-n-m", "60,60,60,4", "--torque-margin",
        "1"},
       2,
       "--torque-margin is out of range"},
      {{"--params", installed("logs/mujoco_delta4/truth.csv"), "--drive-torque-n-m", "4,60,60,4"},
       3,
       "Coulomb friction of drive 1"},
      {{"--cutoff-hz", "600"}, 2, "--cutoff-hz"},
      {{"--away-from-reversals", "1"}, 2, "--away-from-reversals"},
      {{"--segment-files"}, 2, "--segment-files"},
      {{"--criterion", "volume"}, 2, "--criterion"},
      {{"--segments", "2", "--periodic"}, 2, "one segment"},
      {{"--segments", "3", "--segment-speeds", "1,0.5"}, 2, "2 speeds for 3 segments"},
      {{"--torque-scale", "60,60,60,0"}, 2, "torque scale"},
      {{"--time-limit-s", "0"}, 2, "--time-limit-s"},
      {{"--coefficients", shop.path("t.csv")}, 2, "two outputs have the same name"},
  };
  for (const auto& c : cases) {
    const ToolResult result = run(start + c.flags);
    EXPECT_EQ(result.code, c.code) << fmt::format("{}", fmt::join(c.flags, " ")) << "\n" << result.err;
    EXPECT_THAT(result.err, HasSubstr(c.text));
    EXPECT_FALSE(fs::exists(shop.path("t.csv")));
  }
}

}  // namespace
}  // namespace deltadyn::acceptance
