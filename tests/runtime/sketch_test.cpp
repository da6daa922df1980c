#include "deltadyn/runtime/sketch.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <tuple>
#include <utility>

#include "deltadyn/runtime/workspace.hpp"

#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using testing_support::four_limb_description;

std::vector<SketchLines> at_home(const RobotDescription& robot) {
  const auto drawn = make_robot(robot);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(robot.drives()), q = z;
  z.head<3>() = WorkspaceSampler(*drawn).ball().centre;
  EXPECT_EQ(drawn->inverse_kinematics(z, q), Status::ok);
  return sketch_of(*drawn, q);
}

const SketchLines& lines_of(const std::vector<SketchLines>& all, const std::string& label) {
  return *std::ranges::find(all, label, &SketchLines::label);
}

TEST(Sketch, TheBaseGoesRoundWithoutCrossing) {
  // Limbs of a Par4 that are numbered 1, 2, 4, 3 around the base: a line from each to the next would be a bow tie.
  RobotDescription robot = four_limb_description("par4");
  const auto area = [](const auto& corner) {  // twice that of four corners in their order
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i)
      sum += corner(i).x() * corner((i + 1) % 4).y() - corner(i).y() * corner((i + 1) % 4).x();
    return sum;
  };
  const double whole = area([&](std::size_t i) { return robot.limbs[i].p_WD; });
  std::swap(robot.limbs[2], robot.limbs[3]);
  ASSERT_LT(area([&](std::size_t i) { return robot.limbs[i].p_WD; }), 0.5 * whole);
  const std::vector<SketchLines> all = at_home(robot);
  EXPECT_NEAR(area([&](std::size_t i) { return lines_of(all, "base").lines[i].first; }), whole, 1e-12);
}

TEST(Sketch, RailsReachFromEndToEndOfTheTravel) {
  RobotDescription robot = four_limb_description("i4", DriveKind::prismatic);
  for (DriveLimits& limit : robot.limits) std::tie(limit.lower, limit.upper) = std::pair(-0.25, 0.5);
  const std::vector<SketchLines> all = at_home(robot);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& [from, to] = lines_of(all, "rails").lines[2 * i];
    EXPECT_NEAR((to - from).norm(), 0.75, 1e-12);
    EXPECT_NEAR((from - robot.limbs[i].p_WD).norm(), 0.25, 1e-12);
  }
}

TEST(Sketch, ThePlateCarriesATool) {
  for (const char* type : {"h4", "i4", "par4"}) {
    const std::vector<SketchLines> all = at_home(four_limb_description(type));
    ASSERT_TRUE(std::ranges::count(all, "tool", &SketchLines::label) == 1) << type;
    const auto& [from, to] = lines_of(all, "tool").lines.front();
    EXPECT_LT(to.z(), from.z()) << type;
  }
}

}  // namespace
}  // namespace deltadyn
