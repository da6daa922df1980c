// Which joint is which drive, from names as machines have them.

#include <gmock/gmock.h>

#include "deltadyn/io/import_log.hpp"
#include "deltadyn/runtime/error.hpp"

#include "io/recorded_motion.hpp"
#include "io/ros_bag.hpp"
#include "io/temporary_folder.hpp"

namespace deltadyn {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using namespace testing_support;

/// Names in the order of the message, the drive that each is, and what is to be said of it.
struct Joints {
  const char* name;
  std::vector<std::string> joints;
  std::vector<int> drive;  ///< 0: none of the robot's
  const char* note = nullptr;
};

RobotDescription robot_with_yaw() {
  RobotDescription robot = drives(4);
  robot.limbs.resize(3);
  robot.telescope.emplace();
  return robot;
}

class JointNamesTest : public ::testing::TestWithParam<Joints> {};

TEST_P(JointNamesTest, OfABagTellTheDrivesOrTheOrderIsSaidToBeThatOfTheMessage) {
  const TemporaryFolder folder;
  const auto& [name, joints, drive, note] = GetParam();
  const std::vector<double> values(drive.begin(), drive.end());
  {
    Bag bag(folder.path("log.db3"));
    bag.topic(1, "/joint_states", "sensor_msgs/msg/JointState");
    for (int k = 0; k < 50; ++k)
      bag.message(1, 1000000LL * k + 7, joint_state(1000000LL * (k + 1), joints, values, values));
  }
  const RobotDescription robot = robot_with_yaw();
  const Log log = LogImport({folder.path("log.db3")}, robot, {}).log().log;
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(log.q(5, k), k + 1);
    EXPECT_EQ(log.tau(5, k), k + 1);
  }
  if (note != nullptr) {
    EXPECT_THAT(log.notes, Contains(HasSubstr(note)));
  } else {
    EXPECT_THAT(log.notes, Not(Contains(HasSubstr("drive ="))));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Table, JointNamesTest,
    ::testing::Values(
        Joints{"NumberInTheMiddle", {"limb2_joint", "limb3_joint", "limb1_joint", "yaw"}, {2, 3, 1, 4}},
        Joints{"YawFirst", {"yaw_joint", "limb3_joint", "limb1_joint", "limb2_joint"}, {4, 3, 1, 2}},
        Joints{"NumberAtTheEnd", {"motor3", "motor4", "motor1", "motor2"}, {3, 4, 1, 2}},
        Joints{"CountedFromZero", {"axis_2", "axis_0", "axis_1", "axis_3"}, {3, 1, 2, 4}},
        Joints{"NumberInFront", {"3_arm", "1_arm", "2_arm", "tool"}, {3, 1, 2, 4}},
        Joints{"NumberOfTheMachineToo", {"r7_j2", "r7_j1", "r7_j3", "r7_rot"}, {2, 1, 3, 4}},
        Joints{"TwiceTheSameNumber", {"limb2_joint2", "limb1_joint1", "limb3_joint3", "limb4_joint4"}, {2, 1, 3, 4}},
        Joints{"YawWithANumberOfItsOwn", {"tool_1", "limb_3", "limb_1", "limb_2"}, {4, 3, 1, 2}},
        Joints{"Letters", {"arm_c", "arm_a", "arm_b", "tool"}, {3, 1, 2, 4}},
        Joints{"AllLetters", {"driveB", "driveD", "driveA", "driveC"}, {2, 4, 1, 3}},
        Joints{"AxesOfAMachineTool", {"c-axis", "z-axis", "x-axis", "y-axis"}, {4, 3, 1, 2}},
        Joints{"DifferentWords", {"drive-2", "joint_3", "limb1", "yaw"}, {2, 3, 1, 4}},
        Joints{"NamesOfTheRobotFile",
               {"strut1a_y", "drive3", "drive4", "strut2a_y", "drive1", "drive2"},
               {0, 3, 4, 0, 1, 2}},
        Joints{"OneIsLeft", {"limb2", "limb3", "limb1", "spindle"}, {2, 3, 1, 4}, "'spindle' is left over"},
        Joints{"YawCountsAsFirst",
               {"yaw_1", "arm_4", "arm_2", "arm_3"},
               {4, 3, 1, 2},
               "by its number 'yaw_1' would be drive 1"},
        Joints{"NumbersWithGaps", {"j30", "j10", "j20", "j40"}, {3, 1, 2, 4}, "do not run from 1 or 0"},
        Joints{"NoOrder",
               {"left", "right", "rear", "top"},
               {1, 2, 3, 4},
               "'left' as drive 1, 'right' as drive 2, 'rear' as drive 3, 'top' as drive 4: their names tell no order, "
               "so that "
               "of the message is taken; check it, and where it is wrong set drive = in a column map"}),
    [](const auto& one) { return std::string(one.param.name); });

// Columns have no order of a message: PlotJuggler sorts them. Where names tell nothing, the user is asked.
TEST(DriveOrder, ColumnsAreReadByTheirNamesOrAskedFor) {
  const TemporaryFolder folder;
  const RobotDescription robot = robot_with_yaw();
  const auto import = [&](const std::vector<std::string>& joints) {
    std::string head = "__time";
    for (const std::string& joint : joints)
      head += fmt::format(",/joint_states/{0}/effort,/joint_states/{0}/position", joint);
    const auto row = [](int, double t) { return fmt::format("{:.3f},12,2,14,4,13,3,11,1\n", 1.7e9 + t); };
    return LogImport({folder.write("log.csv", recorded(head + "\n", row))}, robot, {});
  };
  for (const auto& joints : {std::vector<std::string>{"limb2_joint", "yaw", "limb3_joint", "limb1_joint"},
                             {"arm_b", "tool", "arm_c", "arm_a"}}) {
    const Log log = import(joints).log().log;
    for (int drive = 0; drive < 4; ++drive) {
      EXPECT_EQ(log.q(9, drive), drive + 1) << joints[0];
      EXPECT_EQ(log.tau(9, drive), drive + 11) << joints[0];
    }
  }
  EXPECT_THROW((void)import({"left", "right", "rear", "top"}).log(), Error);
  EXPECT_THROW((void)import({"limb1", "limb2", "limb3", "spindle"}).log(), Error);
}

// The numbers of field.position0, field.position1 are places in the message; the names stand in columns of their own.
TEST(DriveOrder, PlacesInAMessageAreNoNumbersOfDrives) {
  const TemporaryFolder folder;
  const RobotDescription robot = robot_with_yaw();
  std::string head = "%time";
  for (const char* part : {"name", "position", "effort"}) {
    for (int k = 0; k < 4; ++k) head += fmt::format(",field.{}{}", part, k);
  }
  const auto row = [](int k, double) {
    return fmt::format("{},yaw,limb3,limb1,limb2,4,3,1,2,14,13,11,12\n", 1650000000000000000LL + 1000000LL * k);
  };
  const Log log = LogImport({folder.write("log.csv", recorded(head + "\n", row))}, robot, {}).log().log;
  for (int drive = 0; drive < 4; ++drive) {
    EXPECT_EQ(log.q(9, drive), drive + 1);
    EXPECT_EQ(log.tau(9, drive), drive + 11);
  }
}

}  // namespace
}  // namespace deltadyn
