// delta-model convert as installed: an identified robot for MuJoCo, URDF readers and firmware; what travels along, what
// is listed as left out, what is refused. What the files are worth in other people's programs is tested in tests/peers.

#include <gtest/gtest.h>

#include "acceptance/workshop.hpp"

namespace deltadyn::acceptance {
namespace {

const char* const kFormats[] = {"mjcf", "urdf", "header"};

struct Robot {
  const char* name;
  Words create;  ///< behind `delta-model create`
};
std::ostream& operator<<(std::ostream& out, const Robot& robot) {
  return out << robot.name;
}

class Convert : public ::testing::TestWithParam<Robot> {
 protected:
  Convert() {
    succeed(Words{"delta-model", "create"} + GetParam().create + Words{"-o", path("robot.urdf")});
    succeed({"delta-model", "prior", path("robot.urdf"), "-o", path("params.csv")});
  }
  [[nodiscard]] std::string path(const std::string& name) const { return folder.path(name); }
  [[nodiscard]] Words convert(const std::string& format, const Words& flags = {}) const {
    return Words{"delta-model", "convert", path("robot.urdf"),      "--params",  path("params.csv"), "--to",
                 format,        "-o",      path("model." + format), "--summary", path("summary.csv")} +
           flags;
  }
  const testing_support::TemporaryFolder folder;
  int extra = 0;  ///< files beside robot and parameters that a test has put there
};

TEST_P(Convert, WritesEveryFormat) {
  for (const std::string format : kFormats) {
    const ToolResult result = succeed(convert(format));
    EXPECT_NE(result.out.find("wrote " + path("model." + format)), std::string::npos) << result.out;
    EXPECT_EQ(read_summary(path("summary.csv"))["format"], format);
    const std::string first = read_text(path("model." + format));
    succeed(convert(format));
    EXPECT_EQ(read_text(path("model." + format)), first) << "same input, same file";
  }
  EXPECT_NE(read_text(path("model.mjcf")).find("<mujoco"), std::string::npos);
  EXPECT_NE(read_text(path("model.header")).find("#pragma once"), std::string::npos);
  // The exported URDF is a robot file with the same robot in it.
  const auto robot_of = [](const std::string& file) {
    const std::string info = succeed({"delta-model", "info", file}).out;
    const auto first = info.find("\ngeometry"), last = info.find("\nparameters");
    EXPECT_LT(first, last) << info;
    return info.substr(first, last - first);
  };
  EXPECT_EQ(robot_of(path("model.urdf")), robot_of(path("robot.urdf")));
}

TEST_P(Convert, ClosesTheLoopsInMujoco) {
  succeed(convert("mjcf"));
  const bool loops = std::string(GetParam().name) != "axis";
  EXPECT_EQ(read_text(path("model.mjcf")).find("<equality>") != std::string::npos, loops);
}

TEST_P(Convert, ListsTheEffectsThatItLeavesOut) {
  (void)folder.write("effects.csv",
                     "effect,joint,parameter,value,unit,std\n"
                     "rotor_inertia,drive1,inertia,0.0123,kg*m^2,\n"
                     "asymmetric_coulomb,drive1,offset,0.345,N*m,\n"
                     "stribeck,drive1,friction,2,N*m,\nstribeck,drive1,rate,0.25,rad/s,\nstribeck,drive1,exponent,2,,\n"
                     "saturation,drive1,share,0.5,,\nsaturation,drive1,level,20,N*m,\n");
  if (std::string(GetParam().name) == "linear_delta3") {
    std::string text = folder.read("effects.csv");
    for (const auto& [from, to] :
         {std::pair{"kg*m^2", "kg"}, {"N*m", "N"}, {"N*m", "N"}, {"rad/s", "m/s"}, {"N*m", "N"}}) {
      const auto at = text.find(from);
      text.replace(at, std::string(from).size(), to);
    }
    (void)folder.write("effects.csv", text);
  }
  for (const std::string format : kFormats) {
    const ToolResult result = succeed(convert(format, {"--effects", path("effects.csv")}));
    const std::string model = read_text(path("model." + format));
    int listed = 0;
    std::istringstream lines(result.out);
    for (std::string line; std::getline(lines, line);) {
      const std::string mark = "left out: ";
      if (line.rfind(mark, 0) != 0) continue;
      ++listed;
      EXPECT_NE(model.find(line.substr(mark.size())), std::string::npos) << "the file does not say: " << line;
    }
    EXPECT_EQ(number(read_summary(path("summary.csv")), "left_out"), listed) << format;
    // Friction by rate acts in a controller; what happens to the record only does so nowhere.
    EXPECT_EQ(result.out.find("left out: effect stribeck at drive1 (rate=0.25") == std::string::npos,
              format == "header")
        << result.out;
    EXPECT_EQ(number(read_summary(path("summary.csv")), "effects"), format == "header" ? 1 : 0);
    EXPECT_NE(result.out.find("left out: effect saturation at drive1"), std::string::npos) << result.out;
    EXPECT_EQ(result.out.find("of the record, not of the machine") != std::string::npos, format == "header")
        << result.out;
    EXPECT_EQ(result.out.find("effect rotor_inertia"), std::string::npos) << result.out;
    EXPECT_EQ(result.out.find("effect asymmetric_coulomb"), std::string::npos) << result.out;
    // A constant torque has no place in URDF; everything else finds one.
    EXPECT_EQ(result.out.find("URDF has no constant torque") != std::string::npos, format == "urdf") << result.out;
    if (format == "mjcf") {
      EXPECT_NE(model.find("armature=\"0.0123\""), std::string::npos);
      EXPECT_NE(model.find("-0.345 0 0"), std::string::npos);
    }
  }
}

TEST_P(Convert, RefusesWhatCannotBe) {
  const auto refused = [this](const Words& words, int code, const std::string& says) {
    const ToolResult result = run(words);
    EXPECT_EQ(result.code, code) << result.out << result.err;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_EQ(folder.files(), 2 + extra) << "a file was left behind";
  };
  refused(convert("sdf"), 2, "mjcf");
  refused({"delta-model", "convert", path("robot.urdf"), "--params", path("params.csv"), "-o", path("x")}, 2, "--to");
  refused({"delta-model", "convert", path("robot.urdf"), "--params", path("params.csv"), "--to", "urdf", "-o",
           path("robot.urdf")},
          2, "robot.urdf");
  for (const std::string format : kFormats) refused(convert(format, {"--params", path("none.csv")}), 2, "--params");

  Lines lines = to_lines(read_text(path("params.csv")));
  for (std::size_t k = 1; k <= lines.size(); ++k) {
    if (fields_of(lines[k - 1])[0] == "upper_arm.m") set_field(lines, k, 1, "-1");
  }
  (void)folder.write("negative.csv", lines.empty() ? "" : to_text(lines));
  (void)folder.write("unknown.csv", "effect,joint,parameter,value,unit,std\ngremlin,drive1,size,2,N,\n");
  extra = 2;
  for (const std::string format : kFormats) {
    refused({"delta-model", "convert", path("robot.urdf"), "--params", path("negative.csv"), "--to", format, "-o",
             path("x")},
            3, "upper_arm");
    refused(
        {"delta-model", "convert", path("robot.urdf"), "--params", path("none.csv"), "--to", format, "-o", path("x")},
        3, "none.csv");
    refused(convert(format, {"--effects", path("unknown.csv")}), 3, "unknown.csv, line 2");
  }
}

INSTANTIATE_TEST_SUITE_P(Types, Convert,
                         ::testing::Values(Robot{"delta3",
                                                 {"delta3", "--base-radius", "0.15", "--platform-radius", "0.04",
                                                  "--upper-arm", "0.3", "--strut", "0.7"}},
                                           Robot{"delta4",
                                                 {"delta4", "--base-radius", "0.2", "--platform-radius", "0.05",
                                                  "--upper-arm", "0.525", "--strut", "1.106"}},
                                           Robot{"linear_delta3",
                                                 {"linear-delta3", "--base-radius", "0.3", "--platform-radius", "0.06",
                                                  "--strut", "0.8", "--drive-range-m", "0,0.9"}},
                                           Robot{"axis", {"axis"}}),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace deltadyn::acceptance
