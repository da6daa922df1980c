#include "deltadyn/io/adopt.hpp"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"

#include "support/cad_file.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using ::testing::HasSubstr;
using testing_support::CadFile;
using testing_support::CadOptions;
using testing_support::delta_description;
using testing_support::PlateHangs;
using Vec = Eigen::Vector3d;

NamedValues nominal(const RobotDescription& robot) {
  const auto made = make_robot(robot);
  const NominalParameters values = nominal_parameters(*made, PartShapes(robot));
  NamedValues named;
  for (int k = 0; k < made->parameters(); ++k) {
    const std::string& name = made->parameter_names()[static_cast<std::size_t>(k)];
    if (name.find("viscous") == std::string::npos && name.find("coulomb") == std::string::npos)
      named[name] = values.value(k);
  }
  return named;
}

RobotDescription known(const std::string& type) {
  RobotDescription robot = delta_description(type);
  if (robot.telescope) {
    robot.telescope->p_WU = Vec(0, 0, 0.05);
    robot.telescope->p_BV = Vec(0, 0, 0.02);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    robot.limits[i].lower = robot.drive_kind == DriveKind::prismatic ? 0 : -0.9;
    robot.limits[i].upper = robot.drive_kind == DriveKind::prismatic ? 1.2 : 1.6;
    robot.limits[i].velocity = 3;
    robot.limits[i].effort = 50;
  }
  return robot;
}

void expect_geometry(const RobotDescription& found, const RobotDescription& truth, double tolerance) {
  ASSERT_EQ(found.type, truth.type);
  ASSERT_EQ(found.limbs.size(), truth.limbs.size());
  for (std::size_t i = 0; i < found.limbs.size(); ++i) {
    SCOPED_TRACE(i);
    const auto &a = found.limbs[i], &b = truth.limbs[i];
    EXPECT_NEAR(std::remainder(a.azimuth - b.azimuth, 2 * 3.14159265358979323846), 0, tolerance);
    EXPECT_LT((a.p_WD - b.p_WD).norm(), tolerance) << a.p_WD.transpose();
    EXPECT_LT((a.axis_L - b.axis_L).norm(), tolerance);
    EXPECT_LT((a.p_DE_0 - b.p_DE_0).norm(), tolerance);
    EXPECT_LT((a.p_BA - b.p_BA).norm(), tolerance) << a.p_BA.transpose();
    EXPECT_NEAR(a.strut, b.strut, tolerance);
    EXPECT_NEAR(a.strut_spacing, b.strut_spacing, tolerance);
    EXPECT_EQ(a.elbow, b.elbow);
    EXPECT_NEAR(found.limits[i].lower, truth.limits[i].lower, tolerance);
    EXPECT_NEAR(found.limits[i].upper, truth.limits[i].upper, tolerance);
    EXPECT_EQ(found.limits[i].velocity, truth.limits[i].velocity);
  }
  ASSERT_EQ(found.telescope.has_value(), truth.telescope.has_value());
  if (truth.telescope) {
    EXPECT_LT((found.telescope->p_WU - truth.telescope->p_WU).norm(), tolerance) << found.telescope->p_WU.transpose();
    EXPECT_LT((found.telescope->p_BV - truth.telescope->p_BV).norm(), tolerance) << found.telescope->p_BV.transpose();
  }
}

void expect_parameters(const NamedValues& found, const NamedValues& truth, double tolerance) {
  for (const auto& [name, value] : truth) {
    const auto at = found.find(name);
    if (at == found.end()) {
      ADD_FAILURE() << name << " is missing";
      continue;
    }
    EXPECT_NEAR(at->second, value, tolerance) << name;
  }
}

/// Robot, drawn pose, and what the CAD does to it.
struct Case {
  const char* name;
  const char* type;
  Vec plate;
  std::function<void(CadOptions&)> draw;
  std::function<void(AdoptOptions&)> flags;
  double tolerance = 2e-6;
  friend void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }
};

const auto kPlain = [](CadOptions&) {};
const auto kNone = [](AdoptOptions&) {};
const Vec kMiddle(0, 0, -0.9), kAside(0.12, -0.2, -1.0), kLinearMiddle(0, 0, -1.5), kLinearAside(0.1, 0.15, -1.4);

const Case kCases[] = {
    {"Delta3", "delta3", kAside, kPlain, kNone},
    {"Delta3Symmetric", "delta3", kMiddle, kPlain, kNone},
    {"Delta4", "delta4", kAside, kPlain, kNone},
    {"Delta4Symmetric", "delta4", kMiddle, kPlain, kNone},
    {"Linear", "linear-delta3", kLinearAside, kPlain, kNone},
    {"LinearSymmetric", "linear-delta3", kLinearMiddle, kPlain, kNone},
    {"StraightFrames", "delta3", kAside, [](auto& c) { c.turned_frames = false; }, kNone},
    {"FlippedDrives", "delta3", kAside, [](auto& c) { c.flipped_axes = true; }, kNone},
    {"FlippedRails", "linear-delta3", kLinearAside, [](auto& c) { c.flipped_axes = true; }, kNone},
    {"EndFrames", "delta4", kAside, [](auto& c) { c.end_frames = true; }, kNone},
    {"OneLinkALimb", "delta3", kAside, [](auto& c) { c.one_link_a_limb = true; },
     [](auto& f) { f.strut_spacing = 0.1; }},
    {"OneLinkALimbLinear", "linear-delta3", kLinearAside, [](auto& c) { c.one_link_a_limb = true; },
     [](auto& f) { f.strut_spacing = 0.1; }},
    {"PlateFloats", "delta3", kAside, [](auto& c) { c.plate_hangs = PlateHangs::floating; }, kNone},
    {"PlateFloatsSymmetric", "delta4", kMiddle, [](auto& c) { c.plate_hangs = PlateHangs::floating; },
     [](auto& f) { f.strut = 1.106; }},
    {"PlateIsATreeOfItsOwn", "delta4", kAside, [](auto& c) { c.plate_hangs = PlateHangs::tree_of_its_own; }, kNone},
    {"PlateIsFixedToTheBase", "linear-delta3", kLinearAside, [](auto& c) { c.plate_hangs = PlateHangs::fixed_to_base; },
     [](auto& f) { f.plate = "plate_part"; }},
    {"SixDigits", "delta4", kAside, [](auto& c) { c.digits = 6; }, kNone, 3e-5},
    {"SixDigitsSymmetricWithoutMasses", "linear-delta3", kLinearMiddle,
     [](auto& c) {
       c.digits = 6;
       c.inertials = false;
     },
     kNone, 3e-5},
    {"FourDigits", "delta3", kAside, [](auto& c) { c.digits = 4; }, kNone, 2e-3},
    {"OneHinge", "delta3", kAside, [](auto& c) { c.hinges = 1; }, kNone},
    {"OneHingeLinear", "linear-delta3", kLinearAside, [](auto& c) { c.hinges = 1; }, kNone},
    {"BallOfThreeHinges", "delta4", kAside, [](auto& c) { c.hinges = 3; }, kNone},
    {"Crosspiece", "delta3", kAside, [](auto& c) { c.crosspiece = true; }, kNone},
    {"InMillimetres", "delta4", kAside, [](auto& c) { c.unit = 1000; }, [](auto& f) { f.length_unit = 0.001; }},
};

class Cad : public ::testing::TestWithParam<Case> {};

TEST_P(Cad, GivesBackTheRobotItWasDrawnFrom) {
  const Case& one = GetParam();
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    const RobotDescription truth = known(one.type);
    const NamedValues parameters = nominal(truth);
    CadOptions options;
    options.seed = seed;
    options.plate = one.plate;
    one.draw(options);
    CadFile file(truth, parameters, options);
    const std::string text = file.text();
    AdoptOptions flags;
    one.flags(flags);
    const AdoptedRobot adopted = adopt_robot(text, "cad.urdf", flags);
    expect_geometry(adopted.robot, truth, one.tolerance);
    if (options.inertials) expect_parameters(adopted.parameters, parameters, 2.5 * one.tolerance);
    EXPECT_LT((adopted.robot.gravity - Vec(0, 0, -9.81)).norm(), 1e-9);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(adopted.drives[i].sign, options.flipped_axes && i % 2 == 1 ? -1 : 1);
      EXPECT_NEAR(adopted.drives[i].offset, file.q()(static_cast<Eigen::Index>(i)), one.tolerance) << "drive " << i + 1;
    }
    // The file that is written reads back to the same robot.
    const RobotDescription again = robot_from_urdf(robot_to_urdf(adopted.robot, adopted.parameters), "robot.urdf");
    expect_geometry(again, truth, one.tolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(Table, Cad, ::testing::ValuesIn(kCases),
                         [](const auto& one) { return std::string(one.param.name); });

/// Without masses only the closure of three like limbs tells the plate's radius.
TEST(Adopt, NeedsNoMasses) {
  const RobotDescription truth = known("delta3");
  CadOptions options;
  options.inertials = false;
  for (const Vec& plate : {kAside, kMiddle}) {
    options.plate = plate;
    CadFile file(truth, {}, options);
    const AdoptedRobot adopted = adopt_robot(file.text(), "cad.urdf");
    expect_geometry(adopted.robot, truth, 2e-6);
    EXPECT_TRUE(adopted.parameters.empty());
  }
}

TEST(Adopt, GravityFollowsAWorldAboveTheBase) {
  const RobotDescription truth = known("delta3");
  CadOptions options;
  options.turned_frames = false;
  options.above_base =
      "<link name=\"world\"/><joint name=\"ceiling\" type=\"fixed\"><parent link=\"world\"/><child link=\"base_part\"/>"
      "<origin xyz=\"0 0 2\" rpy=\"3.14159265358979 0 0\"/></joint>\n";
  CadFile file(truth, nominal(truth), options);
  const AdoptedRobot adopted = adopt_robot(file.text(), "cad.urdf");
  expect_geometry(adopted.robot, truth, 2e-6);
  EXPECT_LT((adopted.robot.gravity - Vec(0, 0, 9.81)).norm(), 1e-9) << adopted.robot.gravity.transpose();
}

/// The tree of a robot file stands flat when its joints are zero: no pose of the robot, but its lengths are there.
TEST(Adopt, TakesATreeWhoseZeroIsNoPose) {
  for (const char* type : {"delta3", "delta4", "linear-delta3"}) {
    SCOPED_TRACE(type);
    const RobotDescription truth = known(type);
    const NamedValues parameters = nominal(truth);
    std::string text = robot_to_urdf(truth, parameters);
    const auto loops = text.find("<loop name");
    text = text.substr(0, loops) + "</robot>";
    const AdoptedRobot adopted = adopt_robot(text, "cad.urdf");
    expect_geometry(adopted.robot, truth, 2e-6);
    expect_parameters(adopted.parameters, parameters, 1e-6);
  }
}

struct Ask {
  const char* name;
  std::function<void(CadOptions&)> draw;
  std::function<void(AdoptOptions&)> flags;
  std::function<std::string(std::string)> spoil;
  const char *says, *mend;
  friend void PrintTo(const Ask& one, std::ostream* out) { *out << one.name; }
};

std::string same(std::string text) {
  return text;
}

const Ask kAsks[] = {
    {"Spacing", [](auto& c) { c.one_link_a_limb = true; }, kNone, same, "are one link", "--strut-spacing"},
    {"StrutOfASymmetricPose",
     [](auto& c) {
       c.plate_hangs = PlateHangs::floating;
       c.plate = kMiddle;
     },
     kNone, same, "the length of the struts cannot be found", "--strut"},
    {"Plate", [](auto& c) { c.plate_hangs = PlateHangs::fixed_to_base; }, kNone, same, "no strut carries a plate",
     "--plate LINK"},
    {"PlateUnknown", [](auto& c) { c.plate_hangs = PlateHangs::fixed_to_base; }, [](auto& f) { f.plate = "tray"; },
     same, "no link 'tray'", "name a link"},
    {"DrivesUnknown", kPlain,
     [](auto& f) {
       f.drives = {"J1", "J2", "J3"};
     },
     same, "'J1' is no joint on the base", "name three"},
    {"WrongRadius", kPlain, [](auto& f) { f.platform_radius = 0.2; }, same,
     "--platform-radius is 0.2 m, but the pose of the CAD closes with 0.05", "leave the flag out"},
    {"Millimetres", [](auto& c) { c.unit = 1000; }, kNone, same, "looks like millimetres", "--length-unit mm"},
    {"SpacingGivenTwice", kPlain, [](auto& f) { f.strut_spacing = 0.2; }, same, "--strut-spacing is 0.2 m",
     "leave the flag out"},
    {"NoMassNoFrameNoPlate",
     [](auto& c) {
       c.plate_hangs = PlateHangs::floating;
       c.inertials = false;
     },
     kNone, same, "neither a frame at its end nor a centre of mass", "--platform-radius"},
    {"ASingleArm", kPlain, kNone,
     [](std::string) {
       return std::string(
           "<robot name=\"a\"><link name=\"b\"/><link name=\"c\"/><joint name=\"j\" type=\"continuous\"><parent "
           "link=\"b\"/>"
           "<child link=\"c\"/><axis xyz=\"0 0 1\"/></joint></robot>");
     },
     "no base with three drives", "delta-model create axis"},
    {"Empty", kPlain, kNone, [](std::string) { return std::string(); }, "empty", ""},
};

class CadAsks : public ::testing::TestWithParam<Ask> {};

TEST_P(CadAsks, ByTheNameOfTheFlag) {
  const Ask& ask = GetParam();
  const RobotDescription truth = known("delta3");
  CadOptions options;
  ask.draw(options);
  AdoptOptions flags;
  ask.flags(flags);
  try {
    (void)adopt_robot(ask.spoil(CadFile(truth, nominal(truth), options).text()), "cad.urdf", flags);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.problem(), ::testing::ContainsRegex(ask.says));
    EXPECT_THAT(error.mend(), HasSubstr(ask.mend));
    EXPECT_FALSE(error.mend().empty());
  }
}

INSTANTIATE_TEST_SUITE_P(Table, CadAsks, ::testing::ValuesIn(kAsks),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace deltadyn
