#include "deltadyn/io/robot_file.hpp"

#include <cmath>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <random>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/random.hpp"

#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using ::testing::HasSubstr;

/// Draws geometries of every type, far from the usual symmetric ones.
class RandomRobot {
 public:
  explicit RandomRobot(unsigned seed) : generator_(seed) {}

  RobotDescription delta(const std::string& type) {
    RobotDescription robot;
    robot.name = "random " + type;
    robot.type = type;
    robot.drive_kind = type == "linear-delta3" ? DriveKind::prismatic : DriveKind::revolute;
    for (int i = 0; i < 3; ++i) {
      LimbGeometry<double> limb;
      limb.azimuth = 2 * std::numbers::pi / 3 * i + in(0, 1);
      limb.p_WD = vector(0.3);
      limb.strut = in(0.3, 1.5);
      limb.strut_spacing = in(0.02, 0.3);
      limb.p_BA = vector(0.2);
      limb.elbow = in(-1, 1) > 0 ? 1 : -1;
      if (robot.drive_kind == DriveKind::prismatic) {
        limb.axis_L = vector(1).normalized();
        limb.p_DE_0 = vector(0.1);
      } else {
        limb.axis_L = Vector3<double>::UnitY();
        limb.p_DE_0 = Vector3<double>(in(0.1, 0.8), 0, 0);
      }
      robot.limbs.push_back(limb);
      robot.limits.push_back(limits());
    }
    robot.parts.emplace_back();
    if (type == "delta4") {
      robot.telescope = TelescopeGeometry<double>{vector(0.1), vector(0.1)};
      robot.limits.emplace_back();  // unlimited
    }
    robot.gravity = 9.81 * vector(1).normalized();
    return robot;
  }

  RobotDescription axis(DriveKind kind) {
    RobotDescription robot;
    robot.name = "random axis";
    robot.type = "axis";
    robot.drive_kind = kind;
    LimbGeometry<double> limb;
    limb.azimuth = in(0, 6);
    limb.p_WD = vector(0.3);
    if (kind == DriveKind::prismatic) {
      limb.axis_L = vector(1).normalized();
    } else {
      limb.axis_L = Vector3<double>::UnitY();
      limb.p_DE_0 = Vector3<double>(in(0.1, 0.8), 0, 0);
    }
    robot.limbs.push_back(limb);
    robot.limits.push_back(limits());
    robot.gravity = 9.81 * vector(1).normalized();
    return robot;
  }

  double in(double low, double high) { return UniformDistribution(low, high)(generator_); }
  Vector3<double> vector(double size) { return {in(-size, size), in(-size, size), in(-size, size)}; }

 private:
  DriveLimits limits() {
    DriveLimits limits;
    limits.lower = in(-2, -1);
    limits.upper = in(1, 2);
    limits.velocity = in(1, 9);
    limits.effort = in(1, 90);
    limits.acceleration = in(1, 90);
    return limits;
  }
  std::mt19937 generator_;
};

void expect_same_number(double a, double b, const std::string& what) {
  if (std::isinf(a) || std::isinf(b)) {
    EXPECT_EQ(a, b) << what;
  } else {
    EXPECT_NEAR(a, b, 1e-12) << what;
  }
}

void expect_same(const RobotDescription& a, const RobotDescription& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.type, b.type);
  EXPECT_EQ(a.drive_kind, b.drive_kind);
  EXPECT_EQ(a.parts.size(), b.parts.size());
  EXPECT_EQ(a.plate.has_value(), b.plate.has_value());
  EXPECT_LT((a.gravity - b.gravity).norm(), 1e-12);
  ASSERT_EQ(a.limbs.size(), b.limbs.size());
  for (std::size_t i = 0; i < a.limbs.size(); ++i) {
    const auto &x = a.limbs[i], &y = b.limbs[i];
    EXPECT_NEAR(x.azimuth, y.azimuth, 1e-12);
    EXPECT_LT((x.p_WD - y.p_WD).norm(), 1e-12);
    EXPECT_LT((x.axis_L - y.axis_L).norm(), 1e-12);
    EXPECT_LT((x.p_DE_0 - y.p_DE_0).norm(), 1e-12);
    EXPECT_NEAR(x.strut, y.strut, 1e-12);
    EXPECT_NEAR(x.strut_spacing, y.strut_spacing, 1e-12);
    EXPECT_LT((x.p_BA - y.p_BA).norm(), 1e-12);
    EXPECT_EQ(x.part, y.part);
    EXPECT_EQ(x.elbow, y.elbow);
  }
  ASSERT_EQ(a.telescope.has_value(), b.telescope.has_value());
  if (a.telescope) {
    EXPECT_LT((a.telescope->p_WU - b.telescope->p_WU).norm(), 1e-12);
    EXPECT_LT((a.telescope->p_BV - b.telescope->p_BV).norm(), 1e-12);
  }
  ASSERT_EQ(a.limits.size(), b.limits.size());
  for (std::size_t i = 0; i < a.limits.size(); ++i) {
    expect_same_number(a.limits[i].lower, b.limits[i].lower, "lower");
    expect_same_number(a.limits[i].upper, b.limits[i].upper, "upper");
    expect_same_number(a.limits[i].velocity, b.limits[i].velocity, "velocity");
    expect_same_number(a.limits[i].acceleration, b.limits[i].acceleration, "acceleration");
    expect_same_number(a.limits[i].effort, b.limits[i].effort, "effort");
  }
}

TEST(RobotFile, RoundTripOfRandomGeometries) {
  RandomRobot random(7);
  for (int k = 0; k < 50; ++k) {
    SCOPED_TRACE(k);
    for (const char* type : {"delta3", "linear-delta3", "delta4"}) {
      SCOPED_TRACE(type);
      const RobotDescription robot = random.delta(type);
      expect_same(robot, robot_from_urdf(robot_to_urdf(robot), "memory"));
    }
    for (const DriveKind kind : {DriveKind::revolute, DriveKind::prismatic}) {
      const RobotDescription robot = random.axis(kind);
      expect_same(robot, robot_from_urdf(robot_to_urdf(robot), "memory"));
    }
  }
}

TEST(RobotFile, AzimuthOfAFullTurnStaysInRange) {
  RandomRobot random(8);
  RobotDescription robot = random.delta("delta3");
  robot.limbs[0].azimuth = 0;
  robot.limbs[1].azimuth = 2 * std::numbers::pi / 3;
  robot.limbs[2].azimuth = 4 * std::numbers::pi / 3;
  const RobotDescription back = robot_from_urdf(robot_to_urdf(robot), "memory");
  expect_same(robot, back);
}

TEST(RobotFile, GeometryComesFromTheTreeNotFromTheExtension) {
  RandomRobot random(9);
  const RobotDescription robot = random.delta("delta4");
  std::string text = robot_to_urdf(robot);
  const auto begin = text.find("<deltadyn");
  const auto end = text.find("</deltadyn>");
  ASSERT_NE(begin, std::string::npos);
  text.erase(begin, end + 11 - begin);
  RobotDescription expected = robot;  // what only the extension holds falls back to its default
  expected.gravity = Vector3<double>(0, 0, -9.81);
  for (auto& limb : expected.limbs) limb.elbow = 1;
  for (auto& limits : expected.limits) limits.acceleration = DriveLimits().acceleration;
  expect_same(expected, robot_from_urdf(text, "memory"));
}

TEST(RobotFile, InertialIsAboutTheCentreOfMass) {
  RandomRobot random(10);
  const RobotDescription robot = random.delta("delta3");
  // A rod of 2 kg from 0 to 1 m along x: I about the origin 2/3, about the centre 2/12.
  const std::string text = robot_to_urdf(robot, {{"strut.m", 2},
                                                 {"strut.mcx", 1},
                                                 {"strut.Iyy", 2.0 / 3},
                                                 {"strut.Izz", 2.0 / 3},
                                                 {"strut.Ixx", 0.25},
                                                 {"strut3.m", 4}});
  EXPECT_THAT(text, HasSubstr("<mass value=\"2\"/>"));
  EXPECT_THAT(text, HasSubstr("<mass value=\"4\"/>"));
  EXPECT_THAT(text, HasSubstr("<origin xyz=\"0.5 0 0\""));
  const auto inertia = text.find("iyy=\"");
  ASSERT_NE(inertia, std::string::npos);
  EXPECT_NEAR(std::stod(text.substr(inertia + 5)), 2.0 / 12, 1e-12);
  EXPECT_EQ(robot_to_urdf(robot).find("<inertial>"), std::string::npos);
  EXPECT_THROW((void)robot_to_urdf(robot, {{"strut.m", 0}, {"strut.Ixx", 1}}), Error);
}

TEST(RobotFile, WritesWholeFilesAndReadsThemBack) {
  RandomRobot random(11);
  const RobotDescription robot = random.delta("delta3");
  const std::string path = (std::filesystem::temp_directory_path() / "deltadyn_robot_file_test.urdf").string();
  write_robot_file(path, robot);
  expect_same(robot, read_robot_file(path));
  std::filesystem::remove(path);
  EXPECT_THROW((void)read_robot_file(path), Error);
  EXPECT_THROW((void)read_robot_file(std::filesystem::temp_directory_path().string()), Error);
}

/// One way to break a good file: replace the n-th occurrence of `from` by `to`; the message must hold every word of
/// `says`.
struct Break {
  const char* name;
  const char* type;
  const char* from;
  const char* to;
  std::vector<const char*> says;
  friend void PrintTo(const Break& broken, std::ostream* out) { *out << broken.name; }
};

class RobotFileBroken : public ::testing::TestWithParam<Break> {
 public:
  static RobotDescription plain(const std::string& type) {
    RobotDescription robot = testing_support::delta_description(type, {0.2, 0.05, 0.5, 1.25, 0.125});
    robot.name = "plain";
    return robot;
  }
};

TEST_P(RobotFileBroken, IsRefusedWithTheLinkAndTheRule) {
  const Break& broken = GetParam();
  std::string text = robot_to_urdf(plain(broken.type));
  const auto place = text.find(broken.from);
  ASSERT_NE(place, std::string::npos) << broken.from << "\n" << text;
  text.replace(place, std::string(broken.from).size(), broken.to);
  try {
    (void)robot_from_urdf(text, "robot.urdf");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    EXPECT_THAT(std::string(error.what()), HasSubstr("robot.urdf"));
    for (const char* word : broken.says) EXPECT_THAT(std::string(error.what()), HasSubstr(word));
  }
}

constexpr const char* kLoop2b =
    "<loop name=\"strut2b_end\" type=\"spherical\">\n        <predecessor link=\"strut2b\">\n            <origin "
    "xyz=\"1.25 0 "
    "0\"";

const Break kBreaks[] = {
    {"DriveAxis",
     "delta3",
     "<axis xyz=\"0 1 0\"",
     "<axis xyz=\"1 0 0\"",
     {"joint drive1", "wrong axis", "must have (0, 1, 0)"}},
    {"DriveAxisSign", "delta3", "<axis xyz=\"0 1 0\"", "<axis xyz=\"0 -1 0\"", {"joint drive1", "wrong axis"}},
    {"StrutAxis", "delta3", "<axis xyz=\"0 0 1\"", "<axis xyz=\"1 0 0\"", {"joint strut1a_z", "wrong axis"}},
    {"UnequalStruts",
     "delta3",
     kLoop2b,
     "<loop name=\"strut2b_end\" type=\"spherical\">\n        <predecessor link=\"strut2b\">\n            <origin "
     "xyz=\"1.26 0 "
     "0\"",
     {"strut2b", "unequal struts of limb 2", "1.26"}},
    {"StrutEndOffAxis",
     "delta3",
     kLoop2b,
     "<loop name=\"strut2b_end\" type=\"spherical\">\n        <predecessor link=\"strut2b\">\n            <origin "
     "xyz=\"1.25 "
     "0.01 0\"",
     {"strut2b", "+x of the strut"}},
    {"TagsDoNotMatch",
     "delta3",
     "<loop name=\"strut3a_end\"",
     "<note name=\"strut3a_end\"",
     {"line", "not well-formed"}},
    {"LoopType",
     "delta3",
     "<loop name=\"strut3a_end\" type=\"spherical\"",
     "<loop name=\"strut3a_end\" type=\"revolute\"",
     {"strut3a_end", "ball joint"}},
    {"LoopLinkUnknown",
     "delta3",
     "<predecessor link=\"strut2b\"",
     "<predecessor link=\"strut9\"",
     {"strut2b_end", "unknown link 'strut9'"}},
    {"LoopTwice",
     "delta3",
     "<predecessor link=\"strut2b\"",
     "<predecessor link=\"strut2a\"",
     {"strut2a", "closed already"}},
    {"LoopNotOnPlate",
     "delta3",
     "<successor link=\"platform\"",
     "<successor link=\"base\"",
     {"strut1b_end", "is the plate"}},
    {"UnknownParent",
     "delta3",
     "<parent link=\"strut2a_knuckle\"",
     "<parent link=\"elbow\"",
     {"joint strut2a_z", "unknown parent link 'elbow'"}},
    {"TwoParents",
     "delta3",
     "<child link=\"strut2a_knuckle\"",
     "<child link=\"strut1a_knuckle\"",
     {"already hangs on joint"}},
    {"DriveName", "delta3", "name=\"drive2\"", "name=\"motor2\"", {"motor2", "drive1 to drive3"}},
    {"TwoJointsOfOneName", "delta3", "name=\"drive2\"", "name=\"drive1\"", {"two joints of this name"}},
    {"DrivesOfTwoKinds",
     "delta3",
     "name=\"drive2\" type=\"continuous\"",
     "name=\"drive2\" type=\"prismatic\"",
     {"drive2"}},
    {"NotANumber", "delta3", "<origin xyz=\"1.25 0 0\"", "<origin xyz=\"long 0 0\"", {"long"}},
    {"Type", "delta3", "type=\"delta3\"", "type=\"delta4\"", {"says type delta4", "make a delta3"}},
    {"Coupling", "delta3", "<deltadyn", "<coupling name=\"c\"/><deltadyn", {"coupling c"}},
    {"Elbow", "delta3", "elbow=\"+1\"", "elbow=\"2\"", {"elbow", "+1 or -1"}},
    {"UnknownAttribute", "delta3", "elbow=\"+1\"", "elbov=\"+1\"", {"'elbov' is not known"}},
    {"Gravity", "delta3", "xyz_m_s2=\"0 0 -9.81\"", "xyz_m_s2=\"0 0\"", {"gravity", "three numbers"}},
    {"TelescopeAxis", "delta4", "<axis xyz=\"0 0 -1\"", "<axis xyz=\"0 1 0\"", {"joint telescope", "wrong axis"}},
    {"ToolLoopType",
     "delta4",
     "name=\"tool_axis\" type=\"revolute\"",
     "name=\"tool_axis\" type=\"spherical\"",
     {"tool_axis"}},
    {"RootElement", "delta3", "<robot name", "<machine name", {"not well-formed"}},
};

INSTANTIATE_TEST_SUITE_P(Table, RobotFileBroken, ::testing::ValuesIn(kBreaks),
                         [](const auto& entry) { return std::string(entry.param.name); });

std::string without(std::string text, const std::string& begin, const std::string& end) {
  const auto from = text.find(begin);
  const auto to = text.find(end, from);
  EXPECT_NE(from, std::string::npos);
  EXPECT_NE(to, std::string::npos);
  return text.erase(from, to + end.size() - from);
}

void expect_refused(const std::string& text, const std::vector<const char*>& says) {
  try {
    (void)robot_from_urdf(text, "robot.urdf");
    FAIL() << "accepted:\n" << text;
  } catch (const Error& error) {
    for (const char* word : says) EXPECT_THAT(std::string(error.what()), HasSubstr(word));
  }
}

TEST(RobotFile, MissingPartsAreNamed) {
  const std::string delta3 = robot_to_urdf(RobotFileBroken::plain("delta3"));
  const std::string delta4 = robot_to_urdf(RobotFileBroken::plain("delta4"));
  expect_refused(without(delta3, "<loop name=\"strut3a_end\"", "</loop>"), {"missing loop", "strut3a"});
  expect_refused(without(delta4, "<loop name=\"tool_axis\"", "</loop>"), {"missing loop", "tool"});
  expect_refused(without(delta3, "<joint name=\"strut2b_z\"", "</joint>"), {"root"});
  expect_refused(without(without(delta3, "<joint name=\"strut2b_z\"", "</joint>"), "<link name=\"strut2b\"", "</link>"),
                 {"strut2b_end", "unknown link 'strut2b'"});
  const std::string stub =
      without(without(delta3, "<joint name=\"strut2b_z\"", "</joint>"), "<link name=\"strut2b\"", "</link>");
  expect_refused(without(stub, "<loop name=\"strut2b_end\"", "</loop>"), {"strut2b_knuckle", "0 moving joints"});
  expect_refused("", {"empty"});
  expect_refused("t_s,q1_rad\n0,1\n", {"robot.urdf", "XML"});
  expect_refused("<robot name=\"r\"/>", {"no link"});
  expect_refused("<sdf/>", {"<sdf>"});
}

TEST(RobotFile, TheShippedRobotsAreRead) {
  const std::filesystem::path folder = std::filesystem::path(DELTADYN_SOURCE_DIR) / "data" / "robots";
  const std::map<std::string, std::string> types = {{"irb360_6_1600", "delta4"},
                                                    {"mujoco_delta4", "delta4"},
                                                    {"delta_rl5", "delta3"},
                                                    {"emps", "axis"},
                                                    {"linear_delta3", "linear-delta3"},
                                                    {"delta3", "delta3"},
                                                    {"linear_delta3_inclined", "linear-delta3"},
                                                    {"h4", "h4"},
                                                    {"i4", "i4"},
                                                    {"par4_quattro_like", "par4"}};
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".urdf") continue;
    ++files;
    const RobotDescription robot = read_robot_file(entry.path().string());
    ASSERT_EQ(types.count(robot.name), 1U) << robot.name;
    EXPECT_EQ(robot.name, entry.path().stem().string());
    EXPECT_EQ(robot.type, types.at(robot.name));
    expect_same(robot, robot_from_urdf(robot_to_urdf(robot), "memory"));
  }
  EXPECT_EQ(files, types.size());
}

// What the file says twice about a plate must be the same: a person edits one of both.
TEST(RobotFile, EditedPlatesAreRefused) {
  const std::string par4 = robot_to_urdf(testing_support::four_limb_description("par4"));
  const auto edited = [&](const std::string& from, const std::string& to) {
    const auto at = par4.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return std::string(par4).replace(at, from.size(), to);
  };
  ASSERT_NO_THROW((void)robot_from_urdf(par4, "memory"));
  expect_refused(edited(" ratio=\"4\"", ""), {"tool_turn", "4-fold", "1 times as much"});
  expect_refused(edited(" ratio=\"4\"", " ratio=\"1\""), {"tool_turn", "4-fold", "1 times as much"});
  expect_refused(edited(" ratio=\"4\"", " ratio=\"5\""), {"mimics another"});
  expect_refused(edited("range_rad=\"0.9\"", "range_rad=\"0.5\""), {"-0.9 to 0.9", "-0.5 to 0.5", "range_rad"});
  expect_refused(edited("lower=\"-0.9\" upper=\"0.9\"", "lower=\"-0.5\" upper=\"0.5\""),
                 {"by <plate> from -0.9 to 0.9"});
}

TEST(RobotFile, ASerialArmIsNotADelta) {
  const std::string limit = "<axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>";
  expect_refused(
      "<robot name=\"arm\"><link name=\"base\"/><link name=\"l1\"/><link name=\"l2\"/>"
      "<joint name=\"drive1\" type=\"revolute\"><parent link=\"base\"/><child link=\"l1\"/>" +
          limit +
          "</joint>"
          "<joint name=\"j2\" type=\"revolute\"><parent link=\"l1\"/><child link=\"l2\"/>" +
          limit + "</joint></robot>",
      {"three limbs expected"});
}

}  // namespace
}  // namespace deltadyn
