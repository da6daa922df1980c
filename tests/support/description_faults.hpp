#pragma once

/// \file
/// Robots that are spoilt in one way, and what their refusal says.

#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ostream>

#include "deltadyn/runtime/error.hpp"

#include "support/descriptions.hpp"

namespace deltadyn::testing_support {

struct DescriptionFault {
  const char* name;
  const char* type;
  std::function<void(RobotDescription&)> spoil;
  const char* says;
  friend void PrintTo(const DescriptionFault& fault, std::ostream* out) { *out << fault.name; }
};

/// The spoilt robot is refused as bad input, with its file, the words, and what to do.
inline void expect_refused(const DescriptionFault& fault) {
  RobotDescription robot = description_of(fault.type);
  fault.spoil(robot);
  try {
    robot.validate("robot.urdf");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.where(), "robot.urdf");
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    EXPECT_THAT(error.problem(), ::testing::HasSubstr(fault.says));
    EXPECT_FALSE(error.mend().empty());
  }
}

}  // namespace deltadyn::testing_support
