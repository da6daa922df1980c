// delta-model as installed: robot files from lengths, what they say about the robot, and nominal parameters.

#include <algorithm>
#include <gtest/gtest.h>

#include "deltadyn/io/parameter_file.hpp"

#include "acceptance/workshop.hpp"

namespace deltadyn::acceptance {
namespace {

const char* const kTools[] = {"delta-model", "delta-identify", "delta-validate"};

// --- counts -------------------------------------------------------------------------------------

struct Count {
  const char *name, *robot;
  Words flags;
  int base, columns;
};
std::ostream& operator<<(std::ostream& out, const Count& count) {
  return out << count.name;
}

class Counts : public ::testing::TestWithParam<Count> {};

TEST_P(Counts, AreThoseOfThePaper) {
  const Count& count = GetParam();
  const testing_support::TemporaryFolder folder;
  const std::string file = folder.path("info.csv");
  succeed(Words{"delta-model", "info", installed(std::string("robots/") + count.robot), "--summary", file} +
          count.flags);
  const auto summary = read_summary(file);
  EXPECT_EQ(number(summary, "base_parameters"), count.base);
  EXPECT_EQ(number(summary, "columns"), count.columns);
  EXPECT_GT(number(summary, "rank_gap"), 1e4) << "the count is not certain";
}

INSTANTIATE_TEST_SUITE_P(
    Robots, Counts,
    ::testing::Values(Count{"Delta4", "irb360_6_1600.urdf", {}, 37, 70},
                      Count{"Delta4WithoutTool", "irb360_6_1600.urdf", {"--without-tool"}, 34, 60},
                      Count{"Delta4IndividualLimbs", "irb360_6_1600.urdf", {"--individual-limbs"}, 59, 110},
                      Count{"Delta4OfMuJoCo", "mujoco_delta4.urdf", {}, 37, 70},
                      Count{"Delta3", "delta3.urdf", {}, 18, 36}, Count{"DeltaRl5", "delta_rl5.urdf", {}, 18, 36},
                      Count{"H4", "h4.urdf", {}, 25, 60}, Count{"I4", "i4.urdf", {}, 25, 50},
                      Count{"Par4", "par4_quattro_like.urdf", {}, 25, 60},
                      Count{"Par4IndividualLimbs", "par4_quattro_like.urdf", {"--individual-limbs"}, 59, 130}),
    [](const auto& one) { return one.param.name; });

// --- create, info, prior ------------------------------------------------------------------------

struct Type {
  const char* name;
  Words create;  ///< behind `delta-model create`
};
std::ostream& operator<<(std::ostream& out, const Type& type) {
  return out << type.name;
}

class Create : public ::testing::TestWithParam<Type> {};

TEST_P(Create, ReadsBackToWhatWasAskedFor) {
  const testing_support::TemporaryFolder folder;
  const std::string robot = folder.path("robot.urdf"), summary = folder.path("info.csv"),
                    prior = folder.path("prior.csv");
  succeed(Words{"delta-model", "create"} + GetParam().create + Words{"-o", robot});
  const std::string first = folder.read("robot.urdf");

  const ToolResult printed = succeed(Words{"delta-model", "create"} + GetParam().create);
  EXPECT_EQ(printed.out, first) << "standard output and file differ";

  const ToolResult info = succeed({"delta-model", "info", robot, "--summary", summary});
  const auto figures = read_summary(summary);
  const Words& flags = GetParam().create;
  const std::pair<const char*, const char*> keys[] = {
      {"--base-radius", "limb1_base_radius"},     {"--platform-radius", "limb3_platform_radius"},
      {"--upper-arm", "limb2_upper_arm"},         {"--strut", "limb1_strut"},
      {"--strut-spacing", "limb3_strut_spacing"}, {"--gravity-m-s2", "gravity"}};
  for (const auto& [flag, key] : keys) {
    const auto given = std::find(flags.begin(), flags.end(), flag);
    if (given != flags.end()) {
      EXPECT_NEAR(number(figures, key), std::stod(*(given + 1)), 1e-9) << flag;
    }
  }
  const std::string again = folder.path("again.csv");
  EXPECT_EQ(succeed({"delta-model", "info", robot, "--summary", again}).out, info.out);
  EXPECT_EQ(read_text(again), read_text(summary));

  succeed({"delta-model", "prior", robot, "-o", prior});
  const ParameterTable table = read_parameters(prior);
  EXPECT_EQ(static_cast<double>(table.entries.size()), number(figures, "columns"));
  for (const ParameterEntry& entry : table.entries) {
    if (entry.name.size() > 2 && entry.name.substr(entry.name.size() - 2) == ".m") {
      EXPECT_GT(entry.value, 0) << entry.name;
    }
    EXPECT_GT(entry.std, 0) << entry.name;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Types, Create,
    ::testing::Values(Type{"delta3",
                           {"delta3", "--base-radius", "0.15", "--platform-radius", "0.04", "--upper-arm", "0.3",
                            "--strut", "0.7", "--strut-spacing", "0.08"}},
                      Type{"delta4",
                           {"delta4", "--base-radius", "0.21", "--platform-radius", "0.055", "--upper-arm", "0.5",
                            "--strut", "1.1", "--telescope-base-m", "0.01,0,0.05", "--telescope-platform-m", "0,0,0.02",
                            "--gravity-m-s2", "9.80665"}},
                      Type{"delta4_hanging_on_a_wall",
                           {"delta4", "--base-radius", "0.2", "--platform-radius", "0.05", "--upper-arm", "0.525",
                            "--strut", "1.106", "--gravity-direction", "1,0,0"}},
                      Type{"linear_delta3",
                           {"linear-delta3", "--base-radius", "0.3", "--platform-radius", "0.06", "--strut", "0.8",
                            "--drive-range-m", "0,0.9"}},
                      Type{"tilted_linear_delta3",
                           {"linear-delta3", "--base-radius", "0.5", "--platform-radius", "0.06", "--strut", "0.8",
                            "--rail-tilt-rad", "0.3", "--drive-range-m", "0,0.5"}}),
    [](const auto& one) { return one.param.name; });

TEST(Create, MakesAnAxis) {
  const testing_support::TemporaryFolder folder;
  for (const char* kind : {"revolute", "prismatic"}) {
    const std::string robot = folder.path(std::string(kind) + ".urdf"), summary = folder.path("info.csv");
    succeed({"delta-model", "create", "axis", "--drive-kind", kind, "-o", robot});
    succeed({"delta-model", "info", robot, "--summary", summary});
    EXPECT_EQ(number(read_summary(summary), "drives"), 1);
    succeed({"delta-model", "prior", robot, "-o", folder.path("prior.csv")});
  }
}

// The advice says the flags that make the same machine: gravity acts along a vertical axis, and at 60 degrees to one
// that leans by 30.
TEST(Create, OfAnAxisThatIsNotHorizontalNamesTheGravityThatIsAlike) {
  const testing_support::TemporaryFolder folder;
  const Words create = {"delta-model", "create", "axis", "--arm", "0.3", "-o", folder.path("axis.urdf")};
  for (const auto& [axis, gravity] : {std::pair("0,0,1", "--gravity-direction 0,-1,0"),
                                      std::pair("0,0.8660254037844386,0.5", "--gravity-direction 0,-0.5,-0.866025")}) {
    const ToolResult refused = run(create + Words{"--axis-direction", axis});
    EXPECT_EQ(refused.code, 2) << refused.err;
    EXPECT_NE(refused.err.find("leave --axis-direction out"), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find(gravity), std::string::npos) << refused.err;
    const std::string flag = gravity;
    succeed(create + Words{flag.substr(0, flag.find(' ')), flag.substr(flag.find(' ') + 1)});
  }
}

TEST(Create, WritesTheShippedFileAgainByteForByte) {
  const testing_support::TemporaryFolder folder;
  succeed({"delta-model",
           "create",
           "delta4",
           "--name",
           "irb360_6_1600",
           "--base-radius",
           "0.2",
           "--platform-radius",
           "0.05",
           "--upper-arm",
           "0.525",
           "--strut",
           "1.106",
           "--strut-spacing",
           "0.1",
           "--drive-range-rad",
           "-0.9,1.6;-0.9,1.6;-0.9,1.6;-50,50",
           "--drive-velocity-rad-s",
           "10,10,10,48",
           "--drive-acceleration-rad-s2",
           "100,100,100,240",
           "--drive-effort-Nm",
           "60,60,60,4",
           "-o",
           folder.path("robot.urdf")});
  EXPECT_EQ(folder.read("robot.urdf"), read_text(installed("robots/irb360_6_1600.urdf")));
}

TEST(Info, DrawsTheWorkspace) {
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "gnuplot is not installed";
  const testing_support::TemporaryFolder folder;
  succeed({"delta-model", "info", installed("robots/irb360_6_1600.urdf"), "--plot", folder.path("workspace.png")});
  EXPECT_EQ(folder.read("workspace.png").substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(folder.files(), 1);
}

TEST(Info, RefusesPicturesThatAreNotPng) {
  const testing_support::TemporaryFolder folder;
  const ToolResult refused =
      run({"delta-model", "info", installed("robots/delta3.urdf"), "--plot", folder.path("x.jpg")});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("end in .png"), std::string::npos) << refused.err;
  EXPECT_EQ(folder.files(), 0);
}

TEST(Info, DoesNotDependOnThreads) {
  const Words words = {"delta-model", "info", installed("robots/delta3.urdf")};
  const std::string one = succeed(words + Words{"--threads", "1"}).out;
  EXPECT_EQ(succeed(words + Words{"--threads", "2"}).out, one);
  EXPECT_EQ(succeed(words + Words{"--seed", "1"}).out, one) << "the seed is fixed unless given";
}

// --- what all tools have ------------------------------------------------------------------------

TEST(EveryTool, ExplainsItself) {
  for (const char* tool : kTools) {
    const std::string help = succeed({tool, "--help"}).out;
    for (const char* piece : {"Example:", "--version", "--summary", "--config", "--seed", "--threads"}) {
      EXPECT_NE(help.find(piece), std::string::npos) << tool << " --help does not show " << piece;
    }
    EXPECT_NE(succeed({tool, "--version"}).out.find(std::string(tool) + " (deltadyn) "), std::string::npos);
  }
  for (const char* command : {"create", "info", "prior"}) {
    EXPECT_NE(succeed({"delta-model", command, "--help"}).out.find("Example:"), std::string::npos) << command;
  }
}

TEST(EveryTool, TakesFlagsFromAConfigFile) {
  const Workshop w;
  const std::string config = w.write("c.toml", "cutoff-hz=\"33\"\nthreads=1\n");
  Words validate = w.validate();
  validate.resize(validate.size() - 2);  // without --cutoff-hz
  succeed(validate + Words{"--config", config});
  EXPECT_EQ(number(read_summary(w.path("summary.csv")), "cutoff_hz"), 33);
  succeed(validate + Words{"--config", config, "--cutoff-hz", "44"});
  EXPECT_EQ(number(read_summary(w.path("summary.csv")), "cutoff_hz"), 44) << "the command line must win";

  Words identify = w.identify();
  identify.resize(identify.size() - 2);
  succeed(identify + Words{"--config", config});
  EXPECT_EQ(number(read_summary(w.path("summary.csv")), "cutoff_hz"), 33);

  const std::string lengths =
      w.write("lengths.toml", "[create]\nbase-radius=0.2\nplatform-radius=0.05\nupper-arm=0.5\nstrut=1.1\n");
  succeed({"delta-model", "--config", lengths, "create", "delta3", "-o", w.path("made.urdf")});
  succeed({"delta-model", "info", w.path("made.urdf"), "--summary", w.path("info.csv")});
  EXPECT_NEAR(number(read_summary(w.path("info.csv")), "limb1_upper_arm"), 0.5, 1e-12);
}

TEST(EveryTool, RepairsWhatIsSafeAndSaysSo) {
  const Workshop w;
  const std::string log = w.log("repairable.csv", [](Lines& lines) {
    lines.insert(lines.begin() + 900, lines[899]);  // a row twice
    set_field(lines, 300, 6, "nan");
    set_field(lines, 600, 2, "");
    for (std::string& line : lines) line += "\r";  // line ends of another system
    lines[0] = "\xEF\xBB\xBF" + lines[0];          // byte-order mark
    lines.insert(lines.begin() + 1, "# exported by a drive\r");
  });
  const ToolResult result = succeed(w.validate(log));
  EXPECT_NE(result.out.find("line 301, column tau2_Nm: no number, filled in"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("line 601, column q2_rad: no number, filled in"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("line 902: the row is there twice"), std::string::npos) << result.out;
}

TEST(EveryTool, TakesDegreesAndColumnsInAnyOrder) {
  const Workshop w;
  succeed(w.validate());
  const auto expected = read_summary(w.path("summary.csv"));
  const std::string log = w.log("degrees.csv", [](Lines& lines) {
    for (std::size_t k = 0; k < lines.size(); ++k) {
      auto f = fields_of(lines[k]);
      if (k == 0) {
        f[1] = "q1_deg";
      } else {
        f[1] = fmt::format("{:.17g}", std::stod(f[1]) * 180 / 3.14159265358979323846);
      }
      f.push_back(k == 0 ? "temperature_C" : "warm");
      std::reverse(f.begin(), f.end());
      lines[k] = join(f);
    }
  });
  succeed(w.validate(log));
  const auto found = read_summary(w.path("summary.csv"));
  for (int j = 1; j <= 4; ++j) {
    const std::string key = fmt::format("rms_residual_drive{}", j);
    EXPECT_NEAR(number(found, key), number(expected, key), 1e-9) << key;
  }
}

}  // namespace
}  // namespace deltadyn::acceptance
