// Every door to the tools refuses numbers in other units; robots that hang or lean are taken as they are.

#include <gtest/gtest.h>

#include "deltadyn/io/log_file.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"

#include "acceptance/bad_input.hpp"
#include "identification/synthetic_log.hpp"
#include "support/cad_file.hpp"

namespace deltadyn::acceptance {
namespace {

using W = Workshop;

std::string replaced_all(std::string text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

std::string shipped(const std::string& name) {
  return read_text(installed("robots/" + name));
}

/// Every origin times a thousand.
std::string in_millimetres(const std::string& text) {
  const std::string mark = "<origin xyz=\"";
  std::string out;
  std::size_t from = 0;
  for (auto at = text.find(mark); at != std::string::npos; at = text.find(mark, from)) {
    const auto begin = at + mark.size(), end = text.find('"', begin);
    std::istringstream numbers(text.substr(begin, end - begin));
    double x = 0, y = 0, z = 0;
    numbers >> x >> y >> z;
    out += text.substr(from, begin - from) + fmt::format("{} {} {}", 1000 * x, 1000 * y, 1000 * z);
    from = end;
  }
  return out + text.substr(from);
}

/// One shipped robot with a piece of text replaced everywhere.
std::string spoilt(const W& w, const std::string& robot, const std::string& from, const std::string& to) {
  const std::string text = shipped(robot), changed = replaced_all(text, from, to);
  if (text == changed) throw std::runtime_error("no " + from);
  return w.write("bad.urdf", changed);
}

/// delta4 with an `<inertial>` on each upper arm.
std::string with_inertial(const W& w, const std::string& mass, const std::string& moment) {
  std::string text = shipped("mujoco_delta4.urdf");
  for (int i = 1; i <= 3; ++i)
    text = replaced(text, fmt::format("<link name=\"upper_arm{}\">", i),
                    fmt::format("<link name=\"upper_arm{}\"><inertial><origin xyz=\"0.2 0 0\"/><mass value=\"{}\"/>"
                                "<inertia ixx=\"{}\" iyy=\"{}\" izz=\"{}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>",
                                i, mass, moment, moment, moment));
  return w.write("bad.urdf", text);
}

std::vector<Row> robot_files() {
  const std::string limit = "lower=\"-0.9\" upper=\"1.6\"";
  return {
      {"LimbInMillimetres",
       [](const W& w) { return w.info(spoilt(w, "delta3.urdf", "xyz=\"0.15 0 0\"", "xyz=\"150 0 0\"")); },
       3,
       {"bad\\.urdf, line .*joint drive1", "looks like millimetres", "mend: .*150 millimetres are 0\\.15 m"}},
      {"LimbInMillimetresToIdentify",
       [](const W& w) { return w.identify("", spoilt(w, "mujoco_delta4.urdf", "xyz=\"0.2 0 0\"", "xyz=\"200 0 0\"")); },
       3,
       {"bad\\.urdf, line .*joint drive1", "looks like millimetres", "mend:"}},
      {"LoopInMillimetres",
       [](const W& w) { return w.info(spoilt(w, "delta3.urdf", "xyz=\"0.7 0 0\"", "xyz=\"700 0 0\"")); },
       3,
       {"bad\\.urdf, line ", "looks like millimetres", "mend:"}},
      {"AWholeFileInMillimetresNamesTheWayOut",
       [](const W& w) { return w.info(w.write("bad.urdf", in_millimetres(shipped("delta3.urdf")))); },
       3,
       {"bad\\.urdf, line .*joint drive1", "looks like millimetres",
        "mend: .*delta-model adopt .*bad\\.urdf --length-unit mm"}},
      {"LimitsInDegrees",
       [limit](const W& w) { return w.info(spoilt(w, "delta3.urdf", limit, "lower=\"-50\" upper=\"90\"")); },
       3,
       {"bad\\.urdf: drive 1", "looks like degrees", "mend:"}},
      {"VelocityInDegrees",
       [](const W& w) { return w.validate("", spoilt(w, "mujoco_delta4.urdf", "velocity=\"6\"", "velocity=\"344\"")); },
       3,
       {"bad\\.urdf: drive 1", "looks like degrees", "mend:"}},
      {"RailInMillimetres",
       [](const W& w) {
         return Words{"delta-model", "prior", spoilt(w, "linear_delta3.urdf", "upper=\"0.9\"", "upper=\"900\""), "-o",
                      w.path("p.csv")};
       },
       3,
       {"bad\\.urdf: drive 1", "looks like millimetres", "mend:"}},
      {"GravityInMillimetres",
       [](const W& w) { return w.info(spoilt(w, "delta3.urdf", "0 0 -9.81", "0 0 -9810")); },
       3,
       {"bad\\.urdf: the size of gravity", "mend:"}},
      {"NoGravity",
       [](const W& w) { return w.info(spoilt(w, "delta3.urdf", "0 0 -9.81", "0 0 0")); },
       3,
       {"bad\\.urdf: the size of gravity", "mend:"}},
      {"MassInGrams",
       [](const W& w) { return w.info(with_inertial(w, "1500", "0.1")); },
       3,
       {"link upper_arm1: the mass", "looks like grams", "mend:"}},
      {"NegativeMass",
       [](const W& w) { return w.info(with_inertial(w, "-1.5", "0.1")); },
       3,
       {"link upper_arm1: the mass", "mend:"}},
      {"InertiaInSquareMillimetres",
       [](const W& w) { return w.info(with_inertial(w, "1.5", "100000")); },
       3,
       {"link upper_arm1: the inertia", "looks like kg mm", "mend:"}},
  };
}

std::vector<Row> parameter_files() {
  const auto with = [](const std::string& name, const std::string& value, bool identify) {
    return [=](const W& w) {
      const std::string file = w.prior_with("bad.csv", name, value);
      return identify ? w.identify("", "", file) : w.validate("", "", file);
    };
  };
  return {
      {"PriorInGrams",
       with("platform.m", "1230", true),
       3,
       {"bad\\.csv, line", "platform: the mass", "grams", "mend:"}},
      {"ParametersInGrams", with("strut.m", "278", false), 3, {"bad\\.csv, line", "strut: the mass", "grams", "mend:"}},
      {"NegativeMass", with("tool.m", "-0.4", true), 3, {"bad\\.csv, line", "tool: the mass", "mend:"}},
      {"NegativeInertia", with("strut.Iyy", "-0.1", true), 3, {"bad\\.csv, line", "strut: the inertia", "mend:"}},
      {"SquareMillimetres",
       with("upper_arm.Iyy", "189000", false),
       3,
       {"bad\\.csv, line", "the inertia", "kg mm", "mend:"}},
      {"NegativeFriction", with("drive1.viscous", "-1.5", true), 3, {"bad\\.csv, line", "drive1\\.viscous", "mend:"}},
      {"NoNumber", with("drive1.viscous", "nan", true), 3, {"bad\\.csv, line", "mend:"}},
  };
}

std::vector<Row> flags() {
  const auto create = [](const Words& more) {
    return [more](const W& w) { return create_delta3(w.path("x.urdf"), 0.15, 0.04, 0.3, 0.7) + more; };
  };
  const auto prior = [](const std::string& robot, const Words& more) {
    return [robot, more](const W& w) {
      return Words{"delta-model", "prior", installed("robots/" + robot), "-o", w.path("x.csv")} + more;
    };
  };
  const auto excite = [](const std::string& robot, const Words& more) {
    return [robot, more](const W& w) {
      return Words{"delta-excite", installed("robots/" + robot), "-o", w.path("x.csv")} + more;
    };
  };
  return {
      {"CreateArmInMillimetres",
       [](const W& w) { return create_delta3(w.path("x.urdf"), 0.15, 0.04, 300, 0.7); },
       2,
       {"--upper-arm is 300 m", "looks like millimetres", "mend:"}},
      {"CreateStrutInCentimetres",
       [](const W& w) { return create_delta3(w.path("x.urdf"), 0.15, 0.04, 0.3, 7); },
       2,
       {"an upper arm of 0\\.3 m does not go with struts of 7 m", "mend:"}},
      {"CreateVelocityInDegrees",
       create({"--drive-velocity-rad-s", "500"}),
       2,
       {"drive 1", "looks like degrees", "mend:"}},
      {"CreateRangeInDegrees", create({"--drive-range-rad=-50,90"}), 2, {"drive 1", "looks like degrees", "mend:"}},
      {"CreateGravityATenth", create({"--gravity-m-s2", "0.981"}), 2, {"--gravity-m-s2", "9\\.84", "mend:"}},
      {"CreateGravityNotANumber", create({"--gravity-m-s2", "nan"}), 2, {"--gravity-m-s2", "mend:"}},
      {"CreateNoGravity", create({"--gravity-m-s2", "0"}), 2, {"--gravity-m-s2", "mend:"}},
      {"CreateByConfigInMillimetres",
       [](const W& w) {
         return Words{"delta-model",
                      "--config",
                      w.write("c.toml", "[create]\nbase-radius=150\nplatform-radius=40\nupper-arm=300\nstrut=700\n"),
                      "create",
                      "delta3",
                      "-o",
                      w.path("x.urdf")};
       },
       2,
       {"looks like millimetres", "mend:"}},
      {"PriorPlateOfHalfATon",
       prior("delta3.urdf", {"--platform-mass-kg", "500"}),
       2,
       {"platform: the mass is 500 kg", "mend:"}},
      {"PriorArmAsWideAsAHouse",
       prior("delta3.urdf", {"--upper-arm-outer-diameter-m", "40"}),
       2,
       {"diameter of the upper arm is 40 m", "mend:"}},
      {"PriorStrutInCentimetres",
       prior("delta3.urdf", {"--strut-outer-diameter-m", "1.2"}),
       2,
       {"diameter of the strut", "mend:"}},
      {"PriorDensityInGrams",
       prior("delta3.urdf", {"--strut-density-kg-m3", "1.6"}),
       2,
       {"density of the strut", "g/cm", "mend:"}},
      {"PriorTelescopeOfADelta3",
       prior("delta3.urdf", {"--telescope-upper-length-m", "0.7"}),
       2,
       {"--telescope-upper-length-m does not belong to this delta3", "mend: leave it out"}},
      {"PriorToolOfADelta3",
       prior("delta3.urdf", {"--tool-mass-kg", "0.7"}),
       2,
       {"--tool-mass-kg does not belong", "mend:"}},
      {"PriorCarriageOfADelta4",
       prior("mujoco_delta4.urdf", {"--carriage-mass-kg", "2"}),
       2,
       {"has no carriage", "mend:"}},
      {"PriorArmOfALinearDelta",
       prior("linear_delta3.urdf", {"--upper-arm-wall-m", "0.003"}),
       2,
       {"has no upper arm", "mend:"}},
      {"PriorStrutsOfAnAxis", prior("emps.urdf", {"--strut-wall-m", "0.001"}), 2, {"has no struts", "mend:"}},
      {"ExciteInDegrees",
       excite("delta3.urdf",
              {"--drive-range-rad=-50,90", "--drive-velocity-rad-s", "500", "--drive-acceleration-rad-s2", "5000"}),
       2,
       {"drive 1", "looks like degrees", "mend:"}},
      {"ExciteInDegreesByConfig",
       [](const W& w) {
         return Words{"delta-excite", installed("robots/delta3.urdf"),
                      "-o",           w.path("x.csv"),
                      "--config",     w.write("c.toml", "drive-velocity-rad-s=500\n")};
       },
       2,
       {"drive 1", "looks like degrees", "mend:"}},
      {"ExciteFarBeyondTheRobotFile",
       excite("delta3.urdf", {"--drive-velocity-rad-s", "30"}),
       2,
       {"drive 1: the velocity limit asked for is 30 rad/s, but the robot file allows 10", "mend: ask for 10"}},
      {"ExciteFarBeyondTheStops",
       excite("delta3.urdf", {"--drive-range-rad=-3,1.6"}),
       2,
       {"lower position limit", "robot file allows -0\\.9", "mend:"}},
      {"ExcitePlateInMillimetres",
       excite("delta3.urdf", {"--platform-velocity-m-s", "4000"}),
       2,
       {"x: the velocity", "mend:"}},
      {"ExciteYawInDegrees",
       excite("irb360_6_1600.urdf", {"--yaw-range-rad", "180"}),
       2,
       {"psi", "looks like degrees", "mend:"}},
      {"ExciteWorkspaceInMillimetres",
       excite("delta3.urdf",
              {"--workspace", "ball", "--workspace-center-m", "0,0,-700", "--workspace-radius-m", "150"}),
       2,
       {"workspace", "looks like millimetres", "mend:"}},
  };
}

class Doors : public ::testing::TestWithParam<Row> {};

TEST_P(Doors, AreShutToOtherUnits) {
  expect_refused(GetParam());
}

INSTANTIATE_TEST_SUITE_P(RobotFiles, Doors, ::testing::ValuesIn(robot_files()), name_of);
INSTANTIATE_TEST_SUITE_P(ParameterFiles, Doors, ::testing::ValuesIn(parameter_files()), name_of);
INSTANTIATE_TEST_SUITE_P(Flags, Doors, ::testing::ValuesIn(flags()), name_of);

/// The robot hangs from a ceiling: identified with the file as the cell has it, and with the plain robot under turned
/// gravity.
TEST(Mounting, AHangingRobotIsIdentifiedAsTheSameRobotUnderTurnedGravity) {
  const Workshop w;
  const std::string plain = shipped("mujoco_delta4.urdf");
  const std::string hung = replaced(plain, "<link name=\"base\">",
                                    "<link name=\"cell\"/><link name=\"beam\"/>"
                                    "<joint name=\"a\" type=\"fixed\"><parent link=\"cell\"/><child link=\"beam\"/>"
                                    "<origin xyz=\"1 2 3\" rpy=\"0 1.5707963267948966 0\"/></joint>"
                                    "<joint name=\"b\" type=\"fixed\"><parent link=\"beam\"/><child link=\"base\"/>"
                                    "<origin xyz=\"0 0 0.2\" rpy=\"0 0.5 0\"/></joint><link name=\"base\">");
  const std::string leaning = w.write("leaning.urdf", hung);
  // Gravity in the base: turned back by pi/2 + 0.5 about y.
  const double angle = 1.5707963267948966 + 0.5;
  const std::string turned =
      w.write("turned.urdf",
              replaced(plain, "xyz_m_s2=\"0 0 -9.81\"",
                       fmt::format("xyz_m_s2=\"{:.17g} 0 {:.17g}\"", 9.81 * std::sin(angle), -9.81 * std::cos(angle))));
  const RobotDescription description = read_robot_file(turned);
  const auto model = make_robot(description);
  const Eigen::VectorXd truth =
      values(read_parameters(w.path("prior.csv")), model->parameter_names(), model->parameter_units());
  testing_support::SyntheticOptions motion;
  motion.torque_noise = 0.05;
  motion.with_derivatives = false;
  write_log(w.path("leaning.csv"), testing_support::synthetic_log(*model, truth, motion), description);
  for (const std::string& robot : {leaning, turned}) {
    succeed(w.identify(w.path("leaning.csv"), robot));
    fs::rename(w.path("out.csv"), robot + ".csv");
  }
  const ParameterTable a = read_parameters(leaning + ".csv"), b = read_parameters(turned + ".csv");
  ASSERT_EQ(a.entries.size(), b.entries.size());
  for (std::size_t k = 0; k < a.entries.size(); ++k) {
    EXPECT_EQ(a.entries[k].name, b.entries[k].name);
    EXPECT_NEAR(a.entries[k].value, b.entries[k].value, 1e-6 * (1 + std::abs(b.entries[k].value))) << a.entries[k].name;
  }
  // Upright the same log does not fit: gravity counts.
  EXPECT_EQ(run(w.identify(w.path("leaning.csv"))).code, 5);
}

// --- robots from CAD programs -------------------------------------------------------------------

/// A file of a CAD program for the robot that the logs were recorded with, with the masses of its truth.
std::string cad_of(const W& w, unsigned seed, const Eigen::Vector3d& plate) {
  const RobotDescription robot = read_robot_file(w.path("robot.urdf"));
  NamedValues masses;
  for (const ParameterEntry& entry : read_parameters(w.path("prior.csv")).entries) masses[entry.name] = entry.value;
  testing_support::CadOptions options;
  options.seed = seed;
  options.plate = plate;
  return w.write("cad.urdf", testing_support::CadFile(robot, masses, options).text());
}

TEST(Adopt, GivesARobotThatIdentifiesAsTheOriginal) {
  const Workshop w;
  const std::string cad = cad_of(w, 3, Eigen::Vector3d(0.1, 0.05, -0.95));
  const std::string robot = w.path("adopted.urdf"), prior = w.path("cad_prior.csv");
  const ToolResult result =
      succeed({"delta-model", "adopt", cad, "-o", robot, "--prior-out", prior, "--summary", w.path("s.csv")});
  EXPECT_NE(result.out.find("drive 4: joint spindle_"), std::string::npos) << result.out;
  EXPECT_EQ(read_summary(w.path("s.csv")).at("type"), "delta4");
  // Lengths and workspace as of the original, from the first line of the geometry to the gravity.
  const auto geometry = [](const std::string& text) {
    const auto from = text.find("geometry"), to = text.find("drives");
    return text.substr(from, to - from);
  };
  EXPECT_EQ(geometry(succeed({"delta-model", "info", robot}).out),
            geometry(succeed({"delta-model", "info", w.path("robot.urdf")}).out));
  const ParameterTable truth = read_parameters(w.path("prior.csv")), found = read_parameters(prior);
  for (const ParameterEntry& entry : truth.entries) {
    const bool friction = entry.unit.find("kg") == std::string::npos;
    ASSERT_NE(found.find(entry.name), nullptr) << entry.name;
    if (friction) continue;  // of which a CAD knows nothing
    EXPECT_NEAR(found.find(entry.name)->value, entry.value, 1e-5) << entry.name;
    EXPECT_GT(found.find(entry.name)->std, 0) << entry.name;
  }
  succeed(w.validate("", robot));
  const auto adopted = read_summary(w.path("summary.csv"));
  succeed(w.validate());
  const auto original = read_summary(w.path("summary.csv"));
  for (int j = 1; j <= 4; ++j) {
    const std::string key = fmt::format("rms_residual_drive{}", j);
    EXPECT_NEAR(number(adopted, key), number(original, key), 1e-4) << key;
  }
}

TEST(Adopt, TurnsAWholeFileOfMillimetres) {
  const Workshop w;
  const std::string robot = w.path("metres.urdf");
  succeed({"delta-model", "adopt", w.write("mm.urdf", in_millimetres(shipped("mujoco_delta4.urdf"))), "--length-unit",
           "mm", "-o", robot});
  std::string expected = succeed({"delta-model", "info", w.path("robot.urdf")}).out,
              found = succeed({"delta-model", "info", robot}).out;
  // Geometry and drives; behind these stand figures of random states, which amplify the last digit of a length.
  const auto lengths = [](const std::string& text) {
    return text.substr(text.find("geometry"), text.find("workspace") - text.find("geometry"));
  };
  EXPECT_EQ(lengths(found), lengths(expected));
}

std::vector<Row> adoptions() {
  const auto adopt = [](const W& w, const std::string& text, const Words& more = {}) {
    return Words{"delta-model",    "adopt",       w.write("c.urdf", text), "-o",
                 w.path("x.urdf"), "--prior-out", w.path("x.csv")} +
           more;
  };
  return {
      {"AdoptMillimetres",
       [=](const W& w) {
         const RobotDescription robot = read_robot_file(w.path("robot.urdf"));
         testing_support::CadOptions options;
         options.unit = 1000;
         return adopt(w, testing_support::CadFile(robot, {}, options).text());
       },
       3,
       {"c\\.urdf, line .*joint", "looks like millimetres", "mend: .*--length-unit mm"}},
      {"AdoptOneLinkALimb",
       [=](const W& w) {
         const RobotDescription robot = read_robot_file(w.path("robot.urdf"));
         testing_support::CadOptions options;
         options.one_link_a_limb = true;
         return adopt(w, testing_support::CadFile(robot, {}, options).text());
       },
       2,
       {"their distance cannot be found", "mend: give --strut-spacing"}},
      {"AdoptALog", [=](const W& w) { return adopt(w, "t_s,q1_rad\n0,1\n"); }, 3, {"c\\.urdf", "XML", "mend:"}},
      {"AdoptASerialArm",
       [=](const W& w) { return adopt(w, shipped("emps.urdf")); },
       3,
       {"no base with three drives", "mend:"}},
      {"AdoptOntoItself",
       [](const W& w) {
         return Words{"delta-model", "adopt", w.path("robot.urdf"), "-o", w.path("robot.urdf")};
       },
       2,
       {"would overwrite the input", "mend:"}},
  };
}

INSTANTIATE_TEST_SUITE_P(Adoptions, Doors, ::testing::ValuesIn(adoptions()), name_of);

}  // namespace
}  // namespace deltadyn::acceptance
