#include "deltadyn/kinematics/posture.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "deltadyn/kinematics/inverse.hpp"
#include "deltadyn/kinematics/motion.hpp"

#include "support/core_instances.hpp"
#include "support/matchers.hpp"
#include "support/oracle_of.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;
using oracles::Dual;
using oracles::Real;

template <class R>
class PostureOf : public ::testing::Test {
 protected:
  static constexpr int kDrives = R::kDrives;

  void draw() {
    geometry = random_geometry<R>(random);
    task = random_task<R>(random);
    Vector<double, kDrives> q;
    ASSERT_EQ(inverse_kinematics(geometry, task.z, q), Status::ok);
    ASSERT_EQ(assemble_posture(geometry, q, task.z, posture), Status::ok);
  }
  /// q with a unit slope in drive i.
  std::vector<Dual<Real>> seeded(int i) const {
    std::vector<Dual<Real>> out;
    for (int k = 0; k < kDrives; ++k) out.push_back(Dual<Real>(Real(posture.q(k)), k == i ? 1.0L : 0.0L));
    return out;
  }

  Random random{9};
  Geometry<double, R> geometry;
  RandomTask<R> task;
  Posture<double, R> posture;
};

using Robots = ::testing::Types<Delta3, LinearDelta3, Delta4, TurningPlate>;
TYPED_TEST_SUITE(PostureOf, Robots);

TYPED_TEST(PostureOf, HasThePlateJacobianOfTheLoopEquations) {
  constexpr int P = kPlateCoordinates<TypeParam>;
  for (int trial = 0; trial < 30; ++trial) {
    this->draw();
    Matrix<double, P, TypeParam::kDrives> expected;
    for (int i = 0; i < TypeParam::kDrives; ++i) {
      const auto y = oracles::plate(oracle_of(this->geometry), this->seeded(i), numbers(this->task.z));
      for (int k = 0; k < P; ++k) expected(k, i) = static_cast<double>(y[static_cast<std::size_t>(k)].slope);
    }
    EXPECT_THAT(this->posture.J_plate, IsNear(expected, 1e-12 * (1 + expected.norm())));
    EXPECT_THAT(task_jacobian(this->posture).template topRows<P>().eval(),
                IsNear(expected, 1e-12 * (1 + expected.norm())));
  }
}

// Strut angles against atan2 and asin of the strut's direction, their Jacobians against central differences of these.
TYPED_TEST(PostureOf, HasTheStrutAnglesAndTheirJacobians) {
  for (int trial = 0; trial < 30; ++trial) {
    this->draw();
    const auto mechanism = oracle_of(this->geometry);
    const auto angles = [&](int limb, const oracles::Numbers& q) {
      const auto i = static_cast<std::size_t>(limb);
      const auto y = oracles::plate(mechanism, q, numbers(this->task.z));
      const oracles::Vec3<Real> w =
          oracles::limb_axes<Real>(mechanism.limbs[i]).transpose() *
          (oracles::attachment_point(mechanism, i, y) - oracles::elbow_point(mechanism, i, q[i]));
      return std::pair<Real, Real>(std::atan2(-w.z(), w.x()), std::asin(w.y() / w.norm()));
    };
    for (int limb = 0; limb < TypeParam::kLimbs; ++limb) {
      const auto& here = this->posture.limbs[limb];
      const auto q = numbers(this->posture.q);
      const auto [beta, gamma] = angles(limb, q);
      EXPECT_NEAR(here.beta.sin, static_cast<double>(std::sin(beta)), 1e-13);
      EXPECT_NEAR(here.beta.cos, static_cast<double>(std::cos(beta)), 1e-13);
      EXPECT_NEAR(here.gamma.sin, static_cast<double>(std::sin(gamma)), 1e-13);
      EXPECT_NEAR(here.gamma.cos, static_cast<double>(std::cos(gamma)), 1e-13);
      for (int drive = 0; drive < TypeParam::kDrives; ++drive) {
        const Real h = 1e-5L;
        auto more = q, less = q;
        more[static_cast<std::size_t>(drive)] += h;
        less[static_cast<std::size_t>(drive)] -= h;
        const auto [beta_more, gamma_more] = angles(limb, more);
        const auto [beta_less, gamma_less] = angles(limb, less);
        EXPECT_NEAR(here.J_beta(drive), static_cast<double>((beta_more - beta_less) / (2 * h)), 1e-7);
        EXPECT_NEAR(here.J_gamma(drive), static_cast<double>((gamma_more - gamma_less) / (2 * h)), 1e-7);
      }
    }
  }
}

using PostureOfDelta4 = PostureOf<Delta4>;
TEST_F(PostureOfDelta4, HasTheTelescopesLengthAndDirection) {
  for (int trial = 0; trial < 30; ++trial) {
    draw();
    const auto& bar = posture.telescope;
    for (int i = 0; i < Delta4::kDrives; ++i) {
      const auto q = seeded(i);
      const auto mechanism = oracle_of(geometry);
      const auto length = oracles::bar_length(mechanism, oracles::plate(mechanism, q, numbers(task.z)));
      const auto upper = oracles::poses(mechanism, q, numbers(task.z)).back();
      EXPECT_NEAR(bar.length, static_cast<double>(length.value), 1e-13);
      EXPECT_NEAR(bar.J_length(i), static_cast<double>(length.slope), 1e-12);
      Vector3<double> e, J_e;
      for (int k = 0; k < 3; ++k) {
        e(k) = static_cast<double>(upper.R(k, 2).value);
        J_e(k) = static_cast<double>(upper.R(k, 2).slope);
      }
      EXPECT_THAT(bar.e, IsNear(e, 1e-13));
      EXPECT_THAT(bar.J_e.col(i).eval(), IsNear(J_e, 1e-12));
    }
  }
}

/// Symmetric delta whose plate meets the plane of the elbows at q = 0.
Geometry<double, Delta3> flat_delta() {
  Geometry<double, Delta3> geometry;
  for (int i = 0; i < 3; ++i) {
    LimbGeometry<double>& limb = geometry.limbs[i];
    limb.azimuth = i * 2.0943951023931953;
    const Matrix3<double> R_WL = rot_z(SinCos<double>(limb.azimuth));
    limb.p_WD = R_WL * Vector3<double>(0.3, 0, 0);
    limb.p_DE_0 = Vector3<double>(0.3, 0, 0);
    limb.strut = 0.5;
    limb.p_BA = R_WL * Vector3<double>(0.1, 0, 0);
  }
  return geometry;
}

TEST(AssemblePosture, IsSingularWithAllStrutsInOnePlane) {
  const auto geometry = flat_delta();
  Posture<double, Delta3> posture;
  EXPECT_EQ((assemble_posture<double, Delta3>(geometry, Vector3<double>::Zero(), Vector3<double>::Zero(), posture)),
            Status::singular);
}

TEST(AssemblePosture, IsSingularWithAStrutAlongTheLimbsAxis) {
  // Struts one, two, three along x, y, z of the base: the loops are as regular as can be, but limb 2 has its strut on
  // its own y.
  Geometry<double, LinearDelta3> geometry;
  for (int i = 0; i < 3; ++i) {
    geometry.limbs[i].strut = 1;
    geometry.limbs[i].axis_L = Vector3<double>::Unit(i);
  }
  Posture<double, LinearDelta3> posture;
  EXPECT_EQ(
      (assemble_posture<double, LinearDelta3>(geometry, Vector3<double>(-1, -1, -1), Vector3<double>::Zero(), posture)),
      Status::singular);
}

TEST(DriveRates, IsSingularWhereArmAndStrutAreInLine) {
  const auto geometry = flat_delta();
  // Stretched arms: attachment 0.2 m inwards of the drive and sqrt(0.8^2 - 0.2^2) below.
  const double depth = std::sqrt(0.6);
  const double q = std::atan2(depth, -0.2);
  const Vector3<double> z(0, 0, -depth);
  Posture<double, Delta3> posture;
  ASSERT_EQ((assemble_posture<double, Delta3>(geometry, Vector3<double>::Constant(q), z, posture)), Status::ok);
  Vector3<double> qd, qdd;
  EXPECT_EQ(
      (drive_rates<double, Delta3>(geometry, posture, Vector3<double>::UnitZ(), Vector3<double>::Zero(), qd, qdd)),
      Status::singular);
}

}  // namespace
}  // namespace deltadyn
