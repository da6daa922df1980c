#include "../../src/io/plate_tree.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/runtime/error.hpp"

#include "support/descriptions.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using ::testing::HasSubstr;
using testing_support::four_limb_description;
using testing_support::Random;

/// Unequal limbs, tilted, and a plate that stands askew.
RobotDescription crooked_robot(const std::string& type, DriveKind kind, Random& random) {
  RobotDescription robot = four_limb_description(type, kind);
  PlateShape shape = *robot.plate;
  shape.azimuth += random.uniform(-0.3, 0.3);
  if (type == "par4") shape.tool = random.uniform(-1, 1) > 0 ? ToolPlace::centre : ToolPlace::half_plate;
  if (type != "i4") shape.ratio = random.uniform(1, 5);
  robot.set_plate(shape);
  for (auto& limb : robot.limbs) {
    limb.azimuth += random.uniform(-0.2, 0.2);
    limb.tilt = random.uniform(-0.7, 0.7);
    limb.p_WD += random.cube(0.05);
    limb.p_BA += random.cube(0.02);
    limb.strut *= random.uniform(0.9, 1.1);
    if (kind == DriveKind::prismatic) limb.axis_L = (limb.axis_L + random.cube(0.3)).normalized();
  }
  robot.gravity = 9.81 * random.cube(1).normalized();
  return robot;
}

class FourLimbFile : public ::testing::TestWithParam<std::pair<const char*, DriveKind>> {};

TEST_P(FourLimbFile, HoldsTheWholeRobot) {
  const auto [type, kind] = GetParam();
  Random random(11);
  for (int trial = 0; trial < 50; ++trial) {
    const RobotDescription robot = crooked_robot(type, kind, random);
    const RobotDescription back = robot_from_urdf(robot_to_urdf(robot), "memory");
    EXPECT_EQ(back.type, robot.type);
    EXPECT_EQ(back.drive_kind, robot.drive_kind);
    ASSERT_TRUE(back.plate.has_value());
    EXPECT_EQ(back.plate->spacing, robot.plate->spacing);
    EXPECT_EQ(back.plate->ratio, robot.plate->ratio);
    EXPECT_EQ(back.plate->tool, robot.plate->tool);
    EXPECT_LT((back.gravity - robot.gravity).norm(), 1e-12);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto &a = robot.limbs[i], &b = back.limbs[i];
      EXPECT_NEAR(a.azimuth, b.azimuth, 1e-12);
      EXPECT_NEAR(a.tilt, b.tilt, 1e-12);
      EXPECT_LT((a.p_WD - b.p_WD).norm(), 1e-12);
      EXPECT_LT((a.axis_L - b.axis_L).norm(), 1e-12);
      EXPECT_LT((a.p_BA - b.p_BA).norm(), 1e-12);
      EXPECT_NEAR(a.strut, b.strut, 1e-12);
      EXPECT_EQ(a.part, b.part);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Types, FourLimbFile,
                         ::testing::Values(std::pair{"h4", DriveKind::revolute}, std::pair{"h4", DriveKind::prismatic},
                                           std::pair{"i4", DriveKind::revolute}, std::pair{"i4", DriveKind::prismatic},
                                           std::pair{"par4", DriveKind::revolute},
                                           std::pair{"par4", DriveKind::prismatic}));

TEST(TiltedDelta, TheFileHoldsTheTilt) {
  RobotDescription robot = testing_support::delta_description("delta3");
  for (std::size_t i = 0; i < 3; ++i) robot.limbs[i].tilt = 0.3 - 0.2 * static_cast<double>(i);
  const RobotDescription back = robot_from_urdf(robot_to_urdf(robot), "memory");
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(back.limbs[i].tilt, robot.limbs[i].tilt, 1e-12);
}

/// A file of a robot with one text in the place of another, and what is said of it.
void expect_refused(std::string text, const std::string& from, const std::string& to, const std::string& words) {
  const auto at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  try {
    (void)robot_from_urdf(text, "h4.urdf");
    FAIL() << "accepted: " << to;
  } catch (const Error& error) {
    EXPECT_THAT(error.problem(), HasSubstr(words));
    EXPECT_THAT(error.where(), HasSubstr("h4.urdf"));
    EXPECT_FALSE(error.mend().empty());
  }
}

void expect_plate_refused(const std::string& from, const std::string& to, const std::string& words) {
  expect_refused(robot_to_urdf(four_limb_description("h4")), from, to, words);
}

TEST(FourLimbFileFaults, EachIsNamed) {
  expect_plate_refused("type=\"h4\"", "type=\"delta3\"", "its type delta3 says nothing on how its plate is made");
  expect_plate_refused("spacing_m=\"0.12\"", "spacing_m=\"0.2\"", "but the lengths in <plate> put it at");
  expect_plate_refused("spacing_m=\"0.12\"", "spacing_m=\"x\"", "which is not a finite number");
  expect_plate_refused("spacing_m=\"0.12\"", "width_m=\"0.12\"", "'width_m'");
  expect_plate_refused("tool=\"centre\"", "tool=\"left\"", "'left' is not known");
  expect_plate_refused("ratio=\"1\"", "ratio=\"0\"", "ratio of the tool's gear is 0");
  expect_plate_refused("name=\"half_plate2_swing\"", "name=\"swing\"", "half_plate2_swing");
  expect_plate_refused("mimic joint=\"half_plate2_swing\"", "mimic joint=\"drive1\"", "must mimic half_plate2_swing");
  expect_plate_refused("<gravity xyz", "<gravitiy xyz", "<gravitiy> in <deltadyn> is not known");
  expect_plate_refused("<gravity xyz", "<gravity xyz_m_s2=\"0 0 9.81\"/><gravity xyz", "stands on line");
  expect_plate_refused("<drive joint=\"drive2\"", "<drive joint=\"drive1\"", "stands on line");
  expect_plate_refused("<deltadyn ", "<deltadyn/><deltadyn ", "stands on line");
  expect_plate_refused("</deltadyn>", "</deltadyn><deltadny/>", "<deltadny> is not known");
}

/// The first attribute of this name behind a text.
std::string with_attribute(std::string text, const std::string& element, const std::string& key,
                           const std::string& value) {
  const auto at = text.find(key + "=\"", text.find(element)) + key.size() + 2;
  return text.replace(at, text.find('"', at) - at, value);
}

TEST(FourLimbFileFaults, AFixedPartOfThePlateInAnotherPlace) {
  const std::pair<const char*, const char*> parts[] = {
      {"i4", "half_plate2_fixed"}, {"h4", "tool_fixed"}, {"par4", "crossbar1_fixed"}};
  for (const auto& [type, joint] : parts) {
    for (const DriveKind kind : {DriveKind::revolute, DriveKind::prismatic}) {
      const std::string text = robot_to_urdf(four_limb_description(type, kind));
      const std::string quoted = fmt::format("\"{}\"", joint);
      ASSERT_NE(text.find(quoted), std::string::npos) << type;
      EXPECT_NO_THROW((void)robot_from_urdf(text, "memory"));
      for (const auto& [key, value] : {std::pair{"xyz", "0.05 0.02 0.1"}, std::pair{"rpy", "0 0 1"}})
        EXPECT_THROW((void)robot_from_urdf(with_attribute(text, quoted, key, value), "memory"), Error)
            << type << " " << joint << " " << key;
      EXPECT_THROW((void)robot_from_urdf(with_attribute(text, quoted, "parent link", "base"), "memory"), Error)
          << type << " " << joint << " on the base";
    }
  }
}

TEST(FourLimbFileFaults, ThreeLimbsOfAnH4) {
  expect_refused(robot_to_urdf(testing_support::delta_description("delta3")), "type=\"delta3\"", "type=\"h4\"",
                 "the type h4 has four limbs, but 3 found");
}

TEST(FourLimbFileFaults, LengthsOfThePlateAreToldWithTheirLine) {
  const std::string text = robot_to_urdf(four_limb_description("h4"));
  const auto line =
      1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find("<plate ")), '\n');
  for (const char* range : {"-2", "1e-9", "51", "1.5"}) {
    try {
      (void)robot_from_urdf(with_attribute(text, "<plate ", "range_rad", range), "h4.urdf");
      FAIL() << "accepted: " << range;
    } catch (const Error& error) {
      EXPECT_EQ(error.where(), fmt::format("h4.urdf, line {}, <plate> of <deltadyn>", line)) << range;
    }
  }
}

TEST(FourLimbFileFaults, ADriveThatDoesNotMove) {
  const std::string text = robot_to_urdf(four_limb_description("h4"));
  const std::string drive = "name=\"drive2\" type=\"";
  const auto at = text.find(drive) + drive.size();
  expect_refused(text, drive + text.substr(at, text.find('"', at) - at), drive + "fixed", "drive2 is none of those");
}

TEST(FourLimbFileFaults, ALimbOnAPartThatTurns) {
  std::string text = robot_to_urdf(four_limb_description("h4"));
  for (const char* strut : {"strut3a_end", "strut3b_end"}) {
    const auto loop = text.find(strut);
    const auto at = text.find("half_plate2", loop);
    text.replace(at, std::string("half_plate2").size(), "crossbar");
  }
  EXPECT_THROW((void)robot_from_urdf(text, "h4.urdf"), Error);
}

}  // namespace
}  // namespace deltadyn
