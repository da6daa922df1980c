#include "deltadyn/runtime/link_poses.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <string>

#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/runtime/workspace.hpp"

#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;
using Eigen::Vector3d;

struct Member {
  const char* type;
  bool articulated = false;
  DriveKind drives = DriveKind::revolute;
  [[nodiscard]] RobotDescription description() const {
    return articulated ? four_limb_description(type, drives) : delta_description(type);
  }
};

class LinkPosesOf : public ::testing::TestWithParam<Member> {};
INSTANTIATE_TEST_SUITE_P(Types, LinkPosesOf,
                         ::testing::Values(Member{"delta3"}, Member{"linear-delta3"}, Member{"delta4"},
                                           Member{"h4", true}, Member{"i4", true}, Member{"par4", true},
                                           Member{"h4", true, DriveKind::prismatic}),
                         [](const auto& one) {
                           std::string name = one.param.type;
                           std::erase(name, '-');
                           return name + (one.param.drives == DriveKind::prismatic ? "rails" : "");
                         });

// Lengths as in the drawing, at poses as the task coordinates have them: what a picture or an export relies on.
TEST_P(LinkPosesOf, CloseTheLoops) {
  const RobotDescription description = GetParam().description();
  const auto robot = make_robot(description);
  WorkspaceSampler sampler(*robot, 3);
  Eigen::VectorXd q, z(robot->drives());
  for (int k = 0; k < 200; ++k) {
    sampler.next(q);
    LinkPoses at;
    ASSERT_EQ(robot->link_poses(q, at), Status::ok);
    ASSERT_EQ(robot->forward_kinematics(q, z), Status::ok);
    EXPECT_LT((at.plate - z.head<3>()).norm(), 1e-12);
    ASSERT_EQ(at.limbs.size(), description.limbs.size());
    for (std::size_t i = 0; i < at.limbs.size(); ++i) {
      const LimbGeometry<double>& limb = description.limbs[i];
      const LinkPoses::Limb& pose = at.limbs[i];
      EXPECT_LT((pose.elbow + limb.strut * pose.strut - pose.plate).norm(), 1e-10);
      const Vector3d arm = pose.R_WL.transpose() * (pose.elbow - limb.p_WD);
      const double turned = description.drive_kind == DriveKind::revolute ? q(static_cast<Eigen::Index>(i)) : 0;
      const Vector3d moved = description.drive_kind == DriveKind::revolute
                                 ? Vector3d(Eigen::AngleAxisd(turned, Vector3d::UnitY()) * limb.p_DE_0)
                                 : Vector3d(limb.p_DE_0 + q(static_cast<Eigen::Index>(i)) * limb.axis_L);
      EXPECT_LT((arm - moved).norm(), 1e-12);
      const Eigen::Matrix3d R_LS =
          (Eigen::AngleAxisd(pose.beta, Vector3d::UnitY()) * Eigen::AngleAxisd(pose.gamma, Vector3d::UnitZ()))
              .toRotationMatrix();
      EXPECT_LT((pose.R_WL * R_LS.col(0) - pose.strut).norm(), 1e-10);
      if (GetParam().articulated) {
        const Vector3d held = pose.plate - at.parts[static_cast<std::size_t>(limb.part)].place;
        EXPECT_NEAR(held.norm(), limb.p_BA.norm(), 1e-10) << "the attachment stays where it is on its half";
      }
    }
    EXPECT_EQ(at.parts.empty(), !GetParam().articulated);
    if (!description.telescope) continue;
    const Vector3d bar = at.plate + description.telescope->p_BV - description.telescope->p_WU;
    EXPECT_NEAR(at.telescope.length, bar.norm(), 1e-10);
  }
}

TEST(LinkPoses, AreRefusedWhereThePoseIsOutOfReach) {
  const auto robot = make_robot(delta_description("linear-delta3"));
  LinkPoses at;
  EXPECT_NE(robot->link_poses(Eigen::Vector3d(4, -4, 0), at), Status::ok);
  EXPECT_NE(robot->link_poses(Eigen::Vector3d::Constant(std::nan("")), at), Status::ok);
  EXPECT_TRUE(at.limbs.empty());
}

}  // namespace
}  // namespace deltadyn
