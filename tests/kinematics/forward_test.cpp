#include "deltadyn/kinematics/forward.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <gtest/gtest.h>
#include <limits>

#include "deltadyn/kinematics/inverse.hpp"
#include "deltadyn/model/robot_types.hpp"
#include "deltadyn/runtime/geometry_of.hpp"

#include "support/descriptions.hpp"
#include "support/matchers.hpp"
#include "support/oracle_of.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

template <class R, class T>
struct Case {
  using Robot = R;
  using Scalar = T;
};

template <class C>
class ForwardKinematics : public ::testing::Test {
 protected:
  Random random{2};
};

using Cases = ::testing::Types<Case<Delta3, double>, Case<LinearDelta3, double>, Case<Delta4, double>,
                               Case<Delta3, float>, Case<LinearDelta3, float>, Case<Delta4, float>>;
TYPED_TEST_SUITE(ForwardKinematics, Cases);

TYPED_TEST(ForwardKinematics, UndoesInverseKinematics) {
  using R = typename TypeParam::Robot;
  using T = typename TypeParam::Scalar;
  for (int trial = 0; trial < 500; ++trial) {
    const auto geometry = cast_geometry<T>(random_geometry<R>(this->random));
    const Vector<T, R::kDrives> z = random_task<R>(this->random).z.template cast<T>();
    Vector<T, R::kDrives> q, back;
    ASSERT_EQ(inverse_kinematics(geometry, z, q), Status::ok);
    ASSERT_EQ(forward_kinematics(geometry, q, back), Status::ok);
    EXPECT_THAT(back, IsNear(z, 20 * static_cast<double>(std::numeric_limits<T>::epsilon()))) << "trial " << trial;
  }
}

TYPED_TEST(ForwardKinematics, SolvesTheLoopEquationsAsNewtonDoes) {
  using R = typename TypeParam::Robot;
  using T = typename TypeParam::Scalar;
  for (int trial = 0; trial < 50; ++trial) {
    const auto geometry = random_geometry<R>(this->random);
    const auto task = random_task<R>(this->random);
    Vector<double, R::kDrives> q;
    ASSERT_EQ(inverse_kinematics(geometry, task.z, q), Status::ok);
    for (int i = 0; i < R::kDrives; ++i) q(i) += this->random.uniform(-0.05, 0.05);
    Vector<T, R::kDrives> z;
    ASSERT_EQ(forward_kinematics<T>(cast_geometry<T>(geometry), q.template cast<T>(), z), Status::ok);
    const auto y = to_vector<3>(oracles::plate(oracle_of(geometry), numbers(q), numbers(task.z)));
    EXPECT_THAT((z.template head<3>().eval()), IsNear(y, 20 * static_cast<double>(std::numeric_limits<T>::epsilon())));
  }
}

TYPED_TEST(ForwardKinematics, SaysWhenTheStrutsDoNotMeet) {
  using R = typename TypeParam::Robot;
  using T = typename TypeParam::Scalar;
  auto geometry = cast_geometry<T>(random_geometry<R>(this->random));
  for (auto& limb : geometry.limbs) limb.strut = T(0.1);
  Vector<T, R::kDrives> z;
  EXPECT_EQ((forward_kinematics<T, R>(geometry, Vector<T, R::kDrives>::Zero(), z)), Status::unreachable);
}

TYPED_TEST(ForwardKinematics, RefusesWhatIsNotFinite) {
  using R = typename TypeParam::Robot;
  using T = typename TypeParam::Scalar;
  const auto geometry = cast_geometry<T>(random_geometry<R>(this->random));
  for (int i = 0; i < R::kDrives; ++i) {
    Vector<T, R::kDrives> q = Vector<T, R::kDrives>::Zero(), z;
    q(i) = std::numeric_limits<T>::quiet_NaN();
    EXPECT_EQ((forward_kinematics<T, R>(geometry, q, z)), Status::out_of_range);
    Posture<T, R> posture;
    EXPECT_EQ((posture_from_drives<T, R>(geometry, q, posture)), Status::out_of_range);
  }
}

TEST(LowerIntersection, OfThreeSpheresTakesTheLowerPoint) {
  const Vector3<double> centres[3] = {{3, 0, 0}, {0, 4, 0}, {-3, 0, 0}};
  const double radii[3] = {5, 4, 5};
  Vector3<double> p;
  ASSERT_EQ(lower_intersection(centres, radii, p), Status::ok);
  EXPECT_THAT(p, IsNear(Vector3<double>(0, 4, 0) + Vector3<double>(0, -2, -std::sqrt(12.0)), 1e-14));
}

TEST(LowerIntersection, DoesNotDependOnTheOrder) {
  Random random(4);
  for (int trial = 0; trial < 100; ++trial) {
    const Vector3<double> a = random.cube(1), b = random.cube(1), c = random.cube(1), p(0.1, 0.2, -3);
    const double ra = (p - a).norm(), rb = (p - b).norm(), rc = (p - c).norm();
    const Vector3<double> one[3] = {a, b, c}, two[3] = {c, b, a};
    const double r_one[3] = {ra, rb, rc}, r_two[3] = {rc, rb, ra};
    Vector3<double> p_one, p_two;
    ASSERT_EQ(lower_intersection(one, r_one, p_one), Status::ok);
    ASSERT_EQ(lower_intersection(two, r_two, p_two), Status::ok);
    EXPECT_THAT(p_one, IsNear(p_two, 1e-10));
  }
}

TEST(LowerIntersection, IsSingularForCentresInLine) {
  const Vector3<double> in_line[3] = {{0, 0, 0}, {1, 0, 0}, {3, 0, 0}};
  const Vector3<double> same[3] = {{0, 0, 0}, {0, 0, 0}, {3, 0, 0}};
  const double radii[3] = {5, 5, 5};
  Vector3<double> p;
  EXPECT_EQ(lower_intersection(in_line, radii, p), Status::singular);
  EXPECT_EQ(lower_intersection(same, radii, p), Status::singular);
}

TEST(LowerIntersection, IsUnreachableForSpheresApart) {
  const Vector3<double> centres[3] = {{10, 0, 0}, {0, 10, 0}, {-10, 0, 0}};
  const double radii[3] = {5, 5, 5};
  Vector3<double> p;
  EXPECT_EQ(lower_intersection(centres, radii, p), Status::unreachable);
}

template <class R>
class ForwardKinematicsOfFourLimbs : public ::testing::Test {
 protected:
  using Drives = Vector<double, 4>;
  Random random{7};

  /// The default of create in the size of a published robot.
  Geometry<double, R> geometry() {
    RobotDescription robot = four_limb_description(R::kName, R::kDrive);
    return geometry_of<double, R>(robot);
  }

  /// A pose that a machine works in: far from singular, drives in their usual range.
  bool reachable(const Geometry<double, R>& geometry, const Drives& z, Drives& q) {
    if (inverse_kinematics(geometry, z, q) != Status::ok) return false;
    if (R::kDrive == DriveKind::revolute && (q.minCoeff() < -1.0 || q.maxCoeff() > 1.7)) return false;
    Posture<double, R> posture;
    if (assemble_posture(geometry, q, z, posture) != Status::ok) return false;
    Matrix<double, 4, 4> J = posture.J_plate;
    J.row(3) *= Attachments<double, R>(geometry, z(3))(0).first.norm();
    const auto sizes = Eigen::JacobiSVD<Eigen::Matrix4d>(J).singularValues().eval();
    return sizes(0) < 50 * sizes(3) && PlateLoops<double, R>(geometry, q).determinant(z) * geometry.mode > 0;
  }

  Drives pose(const Geometry<double, R>& geometry) {
    const double yaw = geometry.theta_range * geometry.yaw_ratio;
    return Drives(random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), random.uniform(-1.0, -0.4),
                  random.uniform(-yaw, yaw));
  }
};

using FourLimbTypes = ::testing::Types<H4, LinearH4, I4, LinearI4, Par4, LinearPar4>;
TYPED_TEST_SUITE(ForwardKinematicsOfFourLimbs, FourLimbTypes);

TYPED_TEST(ForwardKinematicsOfFourLimbs, FindsThePoseFromNothing) {
  using R = TypeParam;
  const auto geometry = this->geometry();
  Vector<double, 4> q, z;
  int poses = 0, unsure = 0;
  for (int trial = 0; trial < 100000; ++trial) {
    const Vector<double, 4> truth = this->pose(geometry);
    if (!this->reachable(geometry, truth, q)) continue;
    ++poses;
    // Two poses of one mode may belong to the same drives, at the rim; then the plate's last pose decides.
    const Status status = forward_kinematics<double, R>(geometry, q, z);
    unsure += status != Status::ok;
    if (status == Status::ok) {
      ASSERT_LT((z - truth).cwiseAbs().maxCoeff(), 1e-9) << truth.transpose();
    }
  }
  EXPECT_GT(poses, 10000);
  EXPECT_LE(unsure, poses / 10000);
}

TYPED_TEST(ForwardKinematicsOfFourLimbs, FollowsTheLastSetPoint) {
  using R = TypeParam;
  const auto geometry = this->geometry();
  Vector<double, 4> q, z;
  int poses = 0, most = 0;
  for (int trial = 0; trial < 100000; ++trial) {
    const Vector<double, 4> truth = this->pose(geometry);
    if (!this->reachable(geometry, truth, q)) continue;
    ++poses;
    Vector<double, 4> start = truth, solved;
    for (int k = 0; k < 3; ++k) start(k) += this->random.uniform(-0.005, 0.005);  // 5 m/s at 1 kHz
    start(3) += 0.05 * geometry.yaw_ratio * this->random.uniform(-1, 1);
    ASSERT_EQ((forward_kinematics_from<double, R>(geometry, q, start, z)), Status::ok);
    ASSERT_LT((z - truth).cwiseAbs().maxCoeff(), 1e-9) << truth.transpose();
    NewtonRun<double> run;
    solved = start;
    ASSERT_EQ((PlateLoops<double, R>(geometry, q).solve(solved, run)), Status::ok);
    most = std::max(most, run.steps);
  }
  EXPECT_GT(poses, 10000);
  EXPECT_LE(most, kForwardSteps);
}

// From a pose far away nothing says which of two poses is meant: then there is a status, and never the other pose.
TYPED_TEST(ForwardKinematicsOfFourLimbs, IsNeverWrongFromFarAway) {
  using R = TypeParam;
  const auto geometry = this->geometry();
  Vector<double, 4> q, z, start = Vector<double, 4>::Zero();
  start(2) = -0.7;
  int poses = 0, unsure = 0;
  for (int trial = 0; trial < 30000; ++trial) {
    const Vector<double, 4> truth = this->pose(geometry);
    if (!this->reachable(geometry, truth, q)) continue;
    ++poses;
    const Status status = forward_kinematics_from<double, R>(geometry, q, start, z);
    unsure += status != Status::ok;
    if (status == Status::ok) {
      ASSERT_LT((z - truth).cwiseAbs().maxCoeff(), 1e-9) << truth.transpose();
    }
  }
  EXPECT_GT(poses, 3000);
  EXPECT_LE(unsure, poses / 3000);
}

TYPED_TEST(ForwardKinematicsOfFourLimbs, SaysWhenTheStrutsDoNotMeet) {
  using R = TypeParam;
  auto geometry = this->geometry();
  for (auto& limb : geometry.limbs) limb.strut = 0.05;
  Vector<double, 4> z;
  EXPECT_EQ((forward_kinematics<double, R>(geometry, Vector<double, 4>::Zero(), z)), Status::unreachable);
}

TYPED_TEST(ForwardKinematicsOfFourLimbs, WorksInFloat) {
  using R = TypeParam;
  const auto geometry = this->geometry();
  const auto single = cast_geometry<float>(geometry);
  Vector<double, 4> q;
  Vector<float, 4> z;
  for (int trial = 0; trial < 2000; ++trial) {
    Vector<double, 4> truth = 0.5 * this->pose(geometry);
    truth(2) -= 0.3;
    if (!this->reachable(geometry, truth, q)) continue;
    ASSERT_EQ((forward_kinematics<float, R>(single, q.cast<float>(), z)), Status::ok);
    EXPECT_LT((z.cast<double>() - truth).cwiseAbs().maxCoeff(), 1e-4) << truth.transpose();
  }
}

// At the rim of this Par4 two poses of one assembly mode belong to the same drives; the last set point tells them
// apart.
TEST(ForwardKinematicsOfAPar4, TellsTwoPosesApartByTheLast) {
  PlateShape shape = Par4::usual();
  shape.spacing = 0.127;
  shape.bar_spacing = 0.06;
  Geometry<double, Par4> geometry;
  set_plate(shape, geometry);
  for (int i = 0; i < 4; ++i) {
    LimbGeometry<double>& limb = geometry.limbs[i];
    limb.azimuth = (2 * i + 1) * 0.78539816339744831;
    const Vector3<double> radial(std::cos(limb.azimuth), std::sin(limb.azimuth), 0);
    limb.p_WD = 0.15 * radial;
    limb.p_DE_0 = Vector3<double>(0.2, 0, 0);
    limb.strut = 0.51;
    limb.p_BA = 0.09 * radial - geometry.parts[limb.part].a;
  }
  geometry.theta_range = shape.range;
  geometry.mode = plate_mode(geometry);
  using Pose = Vector<double, 4>;
  for (const Pose& truth : {Pose(0.223, 0.077, -0.272, -3.332), Pose(0.278, 0.063, -0.258, -2.94)}) {
    Pose q, z;
    ASSERT_EQ(inverse_kinematics(geometry, truth, q), Status::ok);
    EXPECT_EQ((forward_kinematics<double, Par4>(geometry, q, z)), Status::ambiguous);
    const Pose start = truth + Pose(0.002, -0.001, 0.002, 0.02);
    ASSERT_EQ((forward_kinematics_from<double, Par4>(geometry, q, start, z)), Status::ok);
    EXPECT_THAT(z, IsNear(truth, 1e-9));
  }
}

}  // namespace
}  // namespace deltadyn
