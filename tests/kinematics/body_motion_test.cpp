// Rates of every body, in the body's own frame, against the poses of the oracle differentiated twice.

#include "deltadyn/kinematics/body_motion.hpp"

#include <gtest/gtest.h>

#include "support/core_instances.hpp"
#include "support/matchers.hpp"
#include "support/oracle_of.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;
using oracles::Dual;
using oracles::Mat3;
using oracles::Real;
using oracles::Vec3;

/// v with S(v) = the skew part of M.
Vec3<Real> vee(const Mat3<Real>& M) {
  return Vec3<Real>(M(2, 1) - M(1, 2), M(0, 2) - M(2, 0), M(1, 0) - M(0, 1)) / 2;
}

Vector3<double> rounded(const Vec3<Real>& v) {
  return v.cast<double>();
}

template <class R>
class BodyMotionOf : public ::testing::Test {};
using Robots = ::testing::Types<Delta3, LinearDelta3, Delta4, TurningPlate, Axis, LinearAxis>;
TYPED_TEST_SUITE(BodyMotionOf, Robots);

TYPED_TEST(BodyMotionOf, IsThatOfTheOraclesPoses) {
  using R = TypeParam;
  Random random(12);
  for (int trial = 0; trial < 20; ++trial) {
    const auto geometry = random_geometry<R>(random);
    const auto task = random_task<R>(random);
    Motion<double, R> motion;
    ASSERT_EQ(motion_from_task(geometry, task.z, task.zd, task.zdd, motion), Status::ok);
    const auto mechanism = oracle_of(geometry);
    const auto guess = numbers(task.z);
    const auto moving = oracles::poses(mechanism, in_time(motion.posture.q, motion.qd, motion.qdd), guess);
    std::vector<std::vector<oracles::Pose<Dual<Real>>>> by_drive;
    for (int i = 0; i < R::kDrives; ++i) {
      std::vector<Dual<Real>> q;
      for (int k = 0; k < R::kDrives; ++k) q.push_back(Dual<Real>(motion.posture.q(k), k == i ? 1.0L : 0.0L));
      by_drive.push_back(oracles::poses(mechanism, q, guess));
    }
    const double scale = 1 + motion.qdd.norm() + motion.qd.squaredNorm();
    std::size_t next = 0;
    for_each_body(geometry, motion, [&](Body kind, int index, int count, const BodyMotion<double, R::kDrives>& body) {
      SCOPED_TRACE(std::string(name(kind)) + " " + std::to_string(index));
      for (int copy = 0; copy < count; ++copy, ++next) {  // both struts of a limb must do what the one entry says
        ASSERT_LT(next, moving.size());
        Mat3<Real> rot, rot_d, rot_dd;
        Vec3<Real> p_dd;
        for (int r = 0; r < 3; ++r) {
          p_dd(r) = moving[next].p(r).slope.slope;
          for (int c = 0; c < 3; ++c) {
            rot(r, c) = moving[next].R(r, c).value.value;
            rot_d(r, c) = moving[next].R(r, c).slope.value;
            rot_dd(r, c) = moving[next].R(r, c).slope.slope;
          }
        }
        const Mat3<Real> back = rot.transpose();
        EXPECT_THAT(body.w, IsNear(rounded(vee(back * rot_d)), 1e-12 * scale));
        EXPECT_THAT(body.w_d, IsNear(rounded(vee(back * rot_dd + rot_d.transpose() * rot_d)), 1e-11 * scale));
        EXPECT_THAT(body.a, IsNear(rounded(back * (p_dd - mechanism.gravity)), 1e-11 * scale));
        for (int i = 0; i < R::kDrives; ++i) {
          const auto& pose = by_drive[static_cast<std::size_t>(i)][next];
          Vec3<Real> p_q;
          Mat3<Real> rot_q;
          for (int r = 0; r < 3; ++r) {
            p_q(r) = pose.p(r).slope;
            for (int c = 0; c < 3; ++c) rot_q(r, c) = pose.R(r, c).slope;
          }
          EXPECT_THAT(body.J_v.col(i).eval(), IsNear(rounded(back * p_q), 1e-11));
          EXPECT_THAT(body.J_w.col(i).eval(), IsNear(rounded(vee(back * rot_q)), 1e-11));
        }
      }
    });
    EXPECT_EQ(next, moving.size());
  }
}

}  // namespace
}  // namespace deltadyn
