#include "deltadyn/model/robot_types.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace deltadyn {
namespace {

using ::testing::ElementsAre;

std::string class_of(std::string_view name, DriveKind drives) {
  return visit_robot_type(
      name, drives, [](auto robot) { return std::string(decltype(robot)::kClass); },
      [] { return std::string("none"); });
}

TEST(RobotTypes, ANameAndAKindOfDrivesLeadToAType) {
  EXPECT_EQ(class_of("delta3", DriveKind::revolute), "Delta3");
  EXPECT_EQ(class_of("linear-delta3", DriveKind::prismatic), "LinearDelta3");
  EXPECT_EQ(class_of("delta4", DriveKind::revolute), "Delta4");
  EXPECT_EQ(class_of("h4", DriveKind::revolute), "H4");
  EXPECT_EQ(class_of("h4", DriveKind::prismatic), "LinearH4");
  EXPECT_EQ(class_of("i4", DriveKind::prismatic), "LinearI4");
  EXPECT_EQ(class_of("par4", DriveKind::revolute), "Par4");
  EXPECT_EQ(class_of("axis", DriveKind::prismatic), "LinearAxis");
}

TEST(RobotTypes, WhatIsNoTypeLeadsElsewhere) {
  EXPECT_EQ(class_of("delta3", DriveKind::prismatic), "none");
  EXPECT_EQ(class_of("par", DriveKind::revolute), "none");
  EXPECT_EQ(class_of("", DriveKind::revolute), "none");
}

TEST(RobotTypes, TheListHoldsEachTypeOnce) {
  std::vector<std::string> classes;
  for_each_robot_type([&](auto robot) { classes.emplace_back(decltype(robot)::kClass); });
  EXPECT_THAT(classes, ElementsAre("Delta3", "LinearDelta3", "Delta4", "H4", "LinearH4", "I4", "LinearI4", "Par4",
                                   "LinearPar4", "Axis", "LinearAxis"));
}

}  // namespace
}  // namespace deltadyn
