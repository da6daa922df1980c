// A base that hangs, leans or is turned against the world: the same robot, with gravity turned along.

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <string>

#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/runtime/error.hpp"

#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using testing_support::axis_description;
using testing_support::delta_description;
using Vec = Eigen::Vector3d;

struct FixedJoint {
  Vec xyz, rpy;
};

Eigen::Matrix3d rotation(const Vec& rpy) {
  return (Eigen::AngleAxisd(rpy.z(), Vec::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vec::UnitY()) *
          Eigen::AngleAxisd(rpy.x(), Vec::UnitX()))
      .toRotationMatrix();
}

/// The file with links above the base, the first of them called `root`.
std::string mounted(std::string urdf, const std::vector<FixedJoint>& joints, const std::string& root = "world") {
  std::string above = fmt::format("<link name=\"{}\"/>", root);
  std::string parent = root;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const std::string child = k + 1 == joints.size() ? "base" : fmt::format("stand{}", k);
    const FixedJoint& j = joints[k];
    if (child != "base") above += fmt::format("<link name=\"{}\"/>", child);
    above += fmt::format(
        "<joint name=\"mount{}\" type=\"fixed\"><parent link=\"{}\"/><child link=\"{}\"/>"
        "<origin xyz=\"{} {} {}\" rpy=\"{} {} {}\"/></joint>",
        k, parent, child, j.xyz.x(), j.xyz.y(), j.xyz.z(), j.rpy.x(), j.rpy.y(), j.rpy.z());
    parent = child;
  }
  const auto place = urdf.find("<link name=\"base\">");
  if (place == std::string::npos) {
    const auto empty = urdf.find("<link name=\"base\"/>");
    return urdf.insert(empty, above);
  }
  return urdf.insert(place, above);
}

void expect_same_but_gravity(const RobotDescription& a, const RobotDescription& b) {
  ASSERT_EQ(a.type, b.type);
  ASSERT_EQ(a.limbs.size(), b.limbs.size());
  for (std::size_t i = 0; i < a.limbs.size(); ++i) {
    EXPECT_NEAR(std::remainder(a.limbs[i].azimuth - b.limbs[i].azimuth, 2 * 3.14159265358979323846), 0, 1e-9);
    EXPECT_LT((a.limbs[i].p_WD - b.limbs[i].p_WD).norm(), 1e-9);
    EXPECT_LT((a.limbs[i].axis_L - b.limbs[i].axis_L).norm(), 1e-9);
    EXPECT_LT((a.limbs[i].p_DE_0 - b.limbs[i].p_DE_0).norm(), 1e-9);
    EXPECT_LT((a.limbs[i].p_BA - b.limbs[i].p_BA).norm(), 1e-9);
    EXPECT_NEAR(a.limbs[i].strut, b.limbs[i].strut, 1e-9);
  }
  ASSERT_EQ(a.telescope.has_value(), b.telescope.has_value());
  if (a.telescope) {
    EXPECT_LT((a.telescope->p_WU - b.telescope->p_WU).norm(), 1e-9);
    EXPECT_LT((a.telescope->p_BV - b.telescope->p_BV).norm(), 1e-9);
  }
}

TEST(BaseFrame, FixedJointsBeforeTheRobotTurnGravity) {
  const std::vector<std::vector<FixedJoint>> mounts = {
      {{Vec(0, 0, 1.5), Vec(3.14159265358979, 0, 0)}},  // hangs
      {{Vec(0.3, -0.2, 1), Vec(0, 0, 0)}},              // stands elsewhere
      // Limb 1 is not on +x of the world
      {{Vec(0, 0, 2), Vec(0, 0, 0.7)}},
      {{Vec(0, 0.1, 2), Vec(0.2, -0.4, 1.1)}},                                               // leans
      {{Vec(0, 0, 1), Vec(1.5707963267948966, 0, 0)}, {Vec(0.1, 0, 0), Vec(0, 0.3, -0.5)}},  // a wall, then a wedge
      {{Vec(0, 0, 1), Vec(0.4, 0, 0)}, {Vec(0, 0, 0), Vec(0, 1, 0)}, {Vec(1, 2, 3), Vec(0, 0, 2)}},
  };
  for (const char* type : {"delta3", "linear-delta3", "delta4"})
    for (std::size_t k = 0; k < mounts.size(); ++k) {
      SCOPED_TRACE(fmt::format("{}, mount {}", type, k));
      const RobotDescription robot = delta_description(type);
      const std::string text = mounted(robot_to_urdf(robot), mounts[k], k % 2 == 0 ? "world" : "cell_floor");
      Eigen::Matrix3d R_RW = Eigen::Matrix3d::Identity();
      for (const FixedJoint& joint : mounts[k]) R_RW = R_RW * rotation(joint.rpy);
      const RobotDescription read = robot_from_urdf(text, "robot.urdf");
      expect_same_but_gravity(read, robot);
      EXPECT_LT((read.gravity - R_RW.transpose() * Vec(0, 0, -9.81)).norm(), 1e-9);
      // What is written again is the plain robot under turned gravity.
      const RobotDescription again = robot_from_urdf(robot_to_urdf(read), "again.urdf");
      EXPECT_LT((again.gravity - read.gravity).norm(), 1e-12);
      expect_same_but_gravity(again, robot);
    }
}

TEST(BaseFrame, AnAxisLeans) {
  for (const DriveKind kind : {DriveKind::revolute, DriveKind::prismatic}) {
    const RobotDescription axis = axis_description(kind);
    const Vec rpy(0.3, 1.2, -0.4);
    const RobotDescription read = robot_from_urdf(mounted(robot_to_urdf(axis), {{Vec(0, 1, 0), rpy}}), "axis.urdf");
    expect_same_but_gravity(read, axis);
    EXPECT_LT((read.gravity - rotation(rpy).transpose() * Vec(0, 0, -9.81)).norm(), 1e-9);
  }
}

/// The drives of a CAD tree may hang on brackets of their own, with the turn of the whole in the first joint.
TEST(BaseFrame, DrivesOnBracketsBelowATurnedRoot) {
  const RobotDescription robot = delta_description("delta3");
  std::string text = robot_to_urdf(robot);
  const Eigen::Matrix3d R = rotation(Vec(0.5, -0.3, 0.2));
  for (int i = 1; i <= 3; ++i) {
    const std::string joint = fmt::format("<joint name=\"drive{}\"", i);
    const auto at = text.find(joint);
    ASSERT_NE(at, std::string::npos);
    const auto parent = text.find("<parent link=\"base\"/>", at);
    text.replace(parent, 21, fmt::format("<parent link=\"bracket{}\"/>", i));
    const auto& limb = robot.limbs[static_cast<std::size_t>(i - 1)];
    const Eigen::Matrix3d R_L = Eigen::AngleAxisd(limb.azimuth, Vec::UnitZ()).toRotationMatrix();
    const Vec rpy = (R * R_L).eulerAngles(2, 1, 0);  // yaw, pitch, roll
    const Vec place = R * limb.p_WD;
    const auto origin = text.find("<origin", at), end = text.find("/>", origin);
    text.replace(origin, end + 2 - origin, "<origin xyz=\"0 0 0\" rpy=\"0 0 0\"/>");
    text.insert(
        at, fmt::format("<link name=\"bracket{0}\"/><joint name=\"b{0}\" type=\"fixed\"><parent link=\"base\"/><child "
                        "link=\"bracket{0}\"/><origin xyz=\"{1} {2} {3}\" rpy=\"{4} {5} {6}\"/></joint>",
                        i, place.x(), place.y(), place.z(), rpy.z(), rpy.y(), rpy.x()));
  }
  const RobotDescription read = robot_from_urdf(text, "robot.urdf");
  expect_same_but_gravity(read, robot);
  EXPECT_LT((read.gravity - R.transpose() * Vec(0, 0, -9.81)).norm(), 1e-6);
}

TEST(BaseFrame, ADriveTurnedWronglyIsStillNamed) {
  std::string text = robot_to_urdf(delta_description("delta3"));
  const auto at = text.find("<joint name=\"drive2\"");
  const auto rpy = text.find("rpy=\"0 0 2.09", at);
  ASSERT_NE(rpy, std::string::npos);
  text.replace(rpy, 11, "rpy=\"0 0.2 2");
  try {
    (void)robot_from_urdf(text, "robot.urdf");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("drive"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace deltadyn
