#include "deltadyn/runtime/robot_description.hpp"

#include <cmath>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "deltadyn/runtime/error.hpp"

#include "support/description_faults.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using ::testing::HasSubstr;
using testing_support::axis_description;
using testing_support::delta_description;
using testing_support::DescriptionFault;
using testing_support::expect_refused;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(DriveLimits, AreUnlimitedUnlessGiven) {
  const DriveLimits limits;
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(limits.lower, -infinity);
  EXPECT_EQ(limits.upper, infinity);
  EXPECT_EQ(limits.velocity, infinity);
  EXPECT_EQ(limits.acceleration, infinity);
  EXPECT_EQ(limits.effort, infinity);
}

TEST(RobotDescription, GoodOnesPass) {
  for (const char* type : {"delta3", "linear-delta3", "delta4"})
    EXPECT_NO_THROW(delta_description(type).validate("r")) << type;
  EXPECT_NO_THROW(axis_description(DriveKind::revolute).validate("r"));
  EXPECT_NO_THROW(axis_description(DriveKind::prismatic).validate("r"));
}

TEST(RobotDescription, CountsAndKindsOfDrives) {
  const RobotDescription robot = delta_description("delta4");
  EXPECT_EQ(robot.drives(), 4);
  EXPECT_EQ(robot.kind_of_drive(3), DriveKind::revolute);
  EXPECT_EQ(delta_description("linear-delta3").kind_of_drive(0), DriveKind::prismatic);
}

class FaultyDescription : public ::testing::TestWithParam<DescriptionFault> {};

TEST_P(FaultyDescription, IsRefusedInPlainWords) {
  expect_refused(GetParam());
}

const DescriptionFault kFaults[] = {
    {"UnknownType", "delta3", [](auto& r) { r.type = "scara"; }, "'scara' is not a robot type"},
    {"FourLimbs", "delta3", [](auto& r) { r.type = "par4"; }, "has 4 limbs, but this one has 3"},
    {"Tilt", "delta3", [](auto& r) { r.limbs[0].tilt = kNaN; }, "limb 1: the azimuth or the tilt"},
    {"NoShape", "par4", [](auto& r) { r.plate.reset(); }, "its lengths are missing"},
    {"PlateOfADelta", "delta3", [](auto& r) { r.plate.emplace(); }, "the plate of a delta3 is one part"},
    {"PlateParts", "h4", [](auto& r) { r.parts.pop_back(); }, "has 4 parts, but this one has 3"},
    {"Ratio", "par4", [](auto& r) { r.plate->ratio = 0; }, "the ratio of the tool's gear is 0"},
    {"RatioOfAnI4", "i4", [](auto& r) { r.plate->ratio = 2; }, "the tool sits on the pinion"},
    {"Hinges", "h4", [](auto& r) { r.plate->spacing = 0; }, "distance between the hinges of the two halves is 0"},
    {"Bars", "par4", [](auto& r) { r.plate->bar_spacing = -1; }, "distance between the two bars"},
    {"Pinion", "i4", [](auto& r) { r.plate->pinion_radius = kNaN; }, "radius of the pinion"},
    {"ToolOnAHalf", "h4", [](auto& r) { r.plate->tool = ToolPlace::half_plate; }, "not on a half"},
    {"Millimetres", "h4", [](auto& r) { r.plate->spacing = 120; }, "millimetres"},
    {"Collides", "par4", [](auto& r) { r.plate->range = 1.6; }, "the parts of the plate collide"},
    {"NoRange", "i4", [](auto& r) { r.plate->range = 0; }, "range of theta"},
    {"LimbOnABar", "h4", [](auto& r) { r.limbs[1].part = 2; }, "limb 2 does not end on a half plate"},
    {"CrossedEnds", "i4",
     [](auto& r) {
       for (auto& limb : r.limbs) limb.p_BA = -3 * limb.p_BA;
     },
     "attachments on half plate 1 lie on the side of the other half"},
    {"OneSide", "par4", [](auto& r) { r.limbs[2].part = 0; }, "3 limbs on half plate 1, but two limbs hold each half"},
    {"LooseHalf", "i4", [](auto& r) { r.limbs[1].azimuth = r.limbs[0].azimuth; }, "so the half could turn"},
    {"ThetaNotHeld", "h4",
     [](auto& r) {
       r.plate->azimuth = 0;
       r.set_plate(*r.plate);
     },
     "the limbs do not hold the plate's turn"},
    {"TwoLimbs", "delta3", [](auto& r) { r.limbs.pop_back(); }, "has 3 limbs, but this one has 2"},
    {"Kind", "delta3", [](auto& r) { r.drive_kind = DriveKind::prismatic; }, "drives of a delta3 are revolute"},
    {"NoPlate", "delta3", [](auto& r) { r.parts.clear(); }, "plate"},
    {"PlateTurns", "delta3", [](auto& r) { r.parts[0].kappa = 1; }, "neither turns"},
    {"PlateNaN", "delta3", [](auto& r) { r.parts[0].c.x() = kNaN; }, "neither turns"},
    {"NoTelescope", "delta4", [](auto& r) { r.telescope.reset(); }, "has a telescope bar"},
    {"Telescope", "delta3", [](auto& r) { r.telescope.emplace(); }, "has no telescope bar"},
    {"TelescopeNaN", "delta4", [](auto& r) { r.telescope->p_BV.z() = kNaN; }, "lower joint"},
    {"LimitCount", "delta4", [](auto& r) { r.limits.pop_back(); }, "4 drives, but limits for 3"},
    {"Gravity", "delta3", [](auto& r) { r.gravity.x() = kNaN; }, "gravity"},
    {"Azimuth", "delta3", [](auto& r) { r.limbs[1].azimuth = kNaN; }, "limb 2: the azimuth or the tilt"},
    {"Axis", "delta3", [](auto& r) { r.limbs[0].axis_L = Vector3<double>::UnitZ(); }, "+y of its limb frame"},
    {"AxisLength", "linear-delta3", [](auto& r) { r.limbs[2].axis_L *= 2; },
     "limb 3: the axis of the drive has length 2"},
    {"ArmNegative", "delta3", [](auto& r) { r.limbs[0].p_DE_0.x() = -0.1; }, "length of the upper arm"},
    {"ArmZero", "delta3", [](auto& r) { r.limbs[0].p_DE_0.x() = 0; }, "length of the upper arm"},
    {"ArmTilted", "delta3", [](auto& r) { r.limbs[0].p_DE_0.z() = 0.1; }, "+x of the upper arm"},
    {"Strut", "delta3", [](auto& r) { r.limbs[2].strut = 0; }, "limb 3: the strut length is 0"},
    {"StrutInfinite", "delta3", [](auto& r) { r.limbs[2].strut = std::numeric_limits<double>::infinity(); },
     "strut length"},
    {"Spacing", "delta3", [](auto& r) { r.limbs[1].strut_spacing = -1; }, "distance of the two struts"},
    {"Elbow", "delta3", [](auto& r) { r.limbs[1].elbow = 0; }, "elbow posture"},
    {"Part", "delta3", [](auto& r) { r.limbs[1].part = 1; }, "plate part 1"},
    {"Attachment", "delta3", [](auto& r) { r.limbs[1].p_BA.y() = kNaN; }, "attachment"},
    {"Limits", "delta3", [](auto& r) { r.limits[1].lower = 1, r.limits[1].upper = -1; },
     "drive 2: the lower position limit"},
    {"Velocity", "delta3", [](auto& r) { r.limits[2].velocity = 0; }, "drive 3: the velocity limit"},
    {"Effort", "delta3", [](auto& r) { r.limits[2].effort = kNaN; }, "effort limit"},
    {"Acceleration", "delta3", [](auto& r) { r.limits[2].acceleration = -1; }, "acceleration limit"},
    {"ParallelLimbs", "delta3",
     [](auto& r) {
       for (auto& limb : r.limbs) limb.azimuth = 1;
     },
     "the plate could turn"},
};

INSTANTIATE_TEST_SUITE_P(Table, FaultyDescription, ::testing::ValuesIn(kFaults),
                         [](const auto& entry) { return std::string(entry.param.name); });

}  // namespace
}  // namespace deltadyn
