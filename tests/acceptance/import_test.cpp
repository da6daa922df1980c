// Recordings of other tools come in through the installed delta-log, and the other tools read them as they are.

#include <gtest/gtest.h>

#include "acceptance/workshop.hpp"

namespace deltadyn::acceptance {
namespace {

/// The folder with exports of other tools, which cannot travel with the product; empty if there is none.
std::string exports() {
  const char* folder = std::getenv("DELTADYN_SHARED_DATA");  // NOLINT(concurrency-mt-unsafe)
  const std::string path = folder == nullptr ? "" : std::string(folder) + "/exports/";
  return !path.empty() && fs::exists(path) ? path : "";
}

std::string map_channel(const std::string& quantity, const std::string& source, const std::string& unit) {
  return fmt::format("[[channel]]\ndrive = 1\nquantity = \"{}\"\nsource = \"{}\"\nunit = \"{}\"\n", quantity, source,
                     unit);
}

class ImportTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return workshop_.path(name); }
  std::string axis() const {
    succeed({"delta-model", "create", "axis", "-o", path("axis.urdf")});
    return path("axis.urdf");
  }
  Workshop workshop_;
};

// A log in a German spreadsheet's spelling gives the same answer as the log itself, through import and without it.
TEST_F(ImportTest, OtherToolsReadWhatImportReads) {
  std::string text = to_text(Workshop::good_log());
  for (char& c : text) c = c == ',' ? ';' : (c == '.' ? ',' : c);
  const std::string export_file = workshop_.write("export.csv", "Recorder 3\r\n\r\n" + text);
  const ToolResult imported = succeed({"delta-log", "import", export_file, "--robot", path("robot.urdf"), "--map-out",
                                       path("map.toml"), "-o", path("again.csv")});
  EXPECT_NE(imported.out.find("with decimal comma"), std::string::npos) << imported.out;
  EXPECT_NE(imported.out.find("1500 rows"), std::string::npos) << imported.out;
  succeed(workshop_.validate(path("log.csv")));
  const auto plain = read_summary(path("summary.csv"));
  for (const std::string& file : {path("again.csv"), export_file}) {
    const ToolResult result = succeed(workshop_.validate(file) + Words{"--map", path("map.toml")});
    EXPECT_NEAR(number(read_summary(path("summary.csv")), "rms_residual_drive2"), number(plain, "rms_residual_drive2"),
                1e-9)
        << file;
    EXPECT_NE(result.out.find("q1_rad from 'q1_rad' [rad]"), std::string::npos)
        << "the tool does not say what it took for what";
  }
  const ToolResult guessed = succeed(workshop_.validate(export_file));
  EXPECT_NE(guessed.out.find("read as text separated by ';', with decimal comma"), std::string::npos) << guessed.out;
}

TEST_F(ImportTest, SaysWhatIsMissingAndWritesTheMapToMend) {
  const std::string file =
      workshop_.log("export.csv", [](Lines& lines) { lines[0] = "time,a1,a2,a3,a4,i1 [A],i2 [A],i3 [A],i4 [A]"; });
  const Words import = {"delta-log", "import", file, "--robot", path("robot.urdf")};
  const ToolResult refused = run(import + Words{"-o", path("out.csv"), "--map-out", path("map.toml")});
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.err.find("the file has time, a1, a2, a3, a4, i1 [A]"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("[[channel]]"), std::string::npos) << refused.err;
  EXPECT_FALSE(fs::exists(path("out.csv")));
  std::string map = read_text(path("map.toml"));
  EXPECT_NE(map.find("STILL OPEN"), std::string::npos) << map;
  for (int drive = 1; drive <= 4; ++drive)
    map += fmt::format("[[channel]]\ndrive = {0}\nquantity = \"position\"\nsource = \"a{0}\"\nunit = \"rad\"\n", drive);
  workshop_.write("map.toml", map);
  const ToolResult constant = run(import + Words{"-o", path("out.csv"), "--map", path("map.toml")});
  EXPECT_EQ(constant.code, 3);
  EXPECT_NE(constant.err.find("--torque-constant"), std::string::npos) << constant.err;
  succeed(import + Words{"-o", path("out.csv"), "--map", path("map.toml"), "--torque-constant", "1,1,1,1"});
}

// The map that was written just now is the one to be mended.
TEST_F(ImportTest, NextStepNamesTheMapThatWasWritten) {
  const std::string file = workshop_.log(
      "export.csv", [](Lines& lines) { lines[0] = "t_s,pos1,pos2,pos3,pos4,tau1_Nm,tau2_Nm,tau3_Nm,tau4_Nm"; });
  const ToolResult refused = run(
      {"delta-log", "import", file, "--robot", path("robot.urdf"), "-o", path("out.csv"), "--map-out", path("m.toml")});
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.err.find("mend " + path("m.toml")), std::string::npos) << refused.err;
  EXPECT_EQ(refused.err.find("write a column map"), std::string::npos) << refused.err;
}

TEST_F(ImportTest, ListsAreSeparatedByCommasAndTakeNoFile) {
  const std::string file = workshop_.log(
      "export.csv", [](Lines& lines) { lines[0] = "t_s,q1_rad,q2_rad,q3_rad,q4_rad,i1_A,i2_A,i3_A,i4_A"; });
  const Words import = {"delta-log", "import", "--robot", path("robot.urdf"), "-o", path("out.csv")};
  const ToolResult good = succeed(import + Words{"--torque-constant", "1,1,1,1", file});
  EXPECT_NE(good.out.find("1500 rows"), std::string::npos) << good.out;
  const ToolResult blanks = run(import + Words{"--torque-constant", "11.5", "11.5", "3.2", file});
  EXPECT_EQ(blanks.code, 2);
  EXPECT_NE(blanks.err.find("by commas"), std::string::npos) << blanks.err;
  const ToolResult word = run(import + Words{"--torque-constant", "x", file});
  EXPECT_EQ(word.code, 2);
  EXPECT_NE(word.err.find("delta-log import --help"), std::string::npos) << word.err;
}

TEST_F(ImportTest, RefusesFlagsThatMakeNoSense) {
  const Words import = {"delta-log", "import", path("log.csv"), "--robot", path("robot.urdf"), "-o", path("out.csv")};
  for (const Words& flags : {Words{"--gear-ratio", "2,3"}, Words{"--gear-ratio", "-2"}, Words{"--torque-unit", "rad"},
                             Words{"--time-unit", "weeks"}, Words{"--rate-hz", "0"}}) {
    EXPECT_EQ(run(import + flags).code, 2) << flags[0] << " " << flags[1];
  }
  EXPECT_EQ(run({"delta-log", "import", path("log.csv"), "--robot", path("robot.urdf")}).code, 2);
  EXPECT_EQ(run(import + Words{"--map", path("no.toml")}).code, 3);
}

TEST_F(ImportTest, TwinCatScopeInEveryOptionOfItsExport) {
  if (exports().empty()) GTEST_SKIP() << "DELTADYN_SHARED_DATA names no folder with exports/";
  const std::string robot = axis();
  const std::string map = workshop_.write(
      "map.toml", map_channel("position", "func_OS", "deg") + map_channel("torque", "func_freesample", "mNm"));
  std::string first;
  for (const char* name : {"default", "ContainEOF_true", "DecimalMark_c", "separator_2",
                           "ExcludeDoubleTimestamp_true-SortChannels_false"}) {
    succeed({"delta-log", "import", exports() + "twincat_" + name + ".csv", "--robot", robot, "--map", map, "-o",
             path("out.csv")});
    const std::string log = read_text(path("out.csv"));
    const Lines lines = to_lines(log);
    ASSERT_EQ(lines.size(), 4987U) << name;  // 5 kHz until the slow group ends at 997 ms
    EXPECT_NEAR(field(lines, 4987, 0), 0.997, 1e-9);
    EXPECT_NEAR(field(lines, 4987, 2), 0.997, 1e-9);
    if (first.empty()) first = log;
    EXPECT_EQ(log, first) << name;  // one recording, whatever the options
  }
}

TEST_F(ImportTest, Rosbag2OfAnArm) {
  if (exports().empty()) GTEST_SKIP() << "DELTADYN_SHARED_DATA names no folder with exports/";
  const std::string robot = axis();
  const std::string bag = exports() + "ur10_exciting_trajectory.db3";
  const ToolResult open = run({"delta-log", "import", bag, "--robot", robot, "-o", path("out.csv")});
  EXPECT_EQ(open.code, 3);  // six joints and one drive: only the user knows which
  EXPECT_NE(open.err.find("/joint_states/elbow_joint/position"), std::string::npos) << open.err;
  const std::string map =
      workshop_.write("map.toml", map_channel("position", "/joint_states/elbow_joint/position", "rad") +
                                      map_channel("torque", "/joint_states/elbow_joint/effort", "Nm"));
  succeed({"delta-log", "import", bag, "--robot", robot, "--map", map, "-o", path("out.csv"), "--summary",
           path("summary.csv")});
  const auto summary = read_summary(path("summary.csv"));
  EXPECT_EQ(number(summary, "samples"), 3441);
  EXPECT_NEAR(number(summary, "rate_hz"), 125, 1e-6);
  EXPECT_NEAR(field(to_lines(read_text(path("out.csv"))), 2, 1), 1.66887, 1e-3);
}

}  // namespace
}  // namespace deltadyn::acceptance
