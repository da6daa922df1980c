#include "deltadyn/dynamics/body_inertia.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <vector>

#include "support/matchers.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

struct PointMass {
  double m;
  Vector3<double> r;  ///< from the body's origin, in its frame
};

/// A body of point masses in a random motion of four coordinates: every sum below is over the points, by Newton alone.
class BodyOfPoints : public ::testing::Test {
 protected:
  static constexpr int N = 4;
  using Ten = Vector<double, kInertialParameters>;
  using Shares = Matrix<double, 3, N>;

  void draw() {
    points.clear();
    p.setZero();
    for (int k = 0; k < 6; ++k) {
      points.push_back({random.uniform(0.1, 1), random.cube(0.5)});
      const auto& [m, r] = points.back();
      const Matrix3<double> I = m * (r.squaredNorm() * Matrix3<double>::Identity() - r * r.transpose());
      Ten one;
      one << m, m * r, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(1, 2), I(0, 2);
      p += one;
    }
    for (int j = 0; j < N; ++j) {
      qd(j) = random.uniform(-2, 2);
      body.J_v.col(j) = random.cube(1);
      body.J_w.col(j) = random.cube(1);
      body.Jd_v.col(j) = random.cube(1);
      body.Jd_w.col(j) = random.cube(1);
    }
    body.w = body.J_w * qd;
    body.a = random.cube(10);
    body.w_d = random.cube(10);
    gravity = random.cube(10);
  }
  [[nodiscard]] Vector3<double> acceleration(const Vector3<double>& r) const {
    return body.a + body.w_d.cross(r) + body.w.cross(body.w.cross(r));
  }
  /// Partial velocity of a point by qd, in the body's frame, and its rate as seen from a frame at rest: J_w turns with
  /// the body, and Jd_w is the rate of its components there.
  [[nodiscard]] Shares share(const Vector3<double>& r) const { return body.J_v - skew(r) * body.J_w; }
  [[nodiscard]] Shares share_rate(const Vector3<double>& r) const {
    return body.Jd_v - skew(r) * body.Jd_w - skew(body.w) * skew(r) * body.J_w;
  }

  Random random{17};
  std::vector<PointMass> points;
  Ten p;
  Vector<double, N> qd;
  Vector3<double> gravity;
  BodyState<double, N> body;
};

TEST_F(BodyOfPoints, TakesTheForceAndMomentOfItsPoints) {
  for (int trial = 0; trial < 50; ++trial) {
    draw();
    const BodyInertia<double> inertia(p);
    Vector3<double> force = Vector3<double>::Zero(), moment = Vector3<double>::Zero();
    for (const auto& [m, r] : points) {
      force += m * acceleration(r);
      moment += m * r.cross(acceleration(r));
    }
    EXPECT_THAT(inertia.force(body), IsNear(force, 1e-12 * (1 + force.norm())));
    EXPECT_THAT(inertia.moment(body), IsNear(moment, 1e-12 * (1 + moment.norm())));
    EXPECT_THAT(inertia.inertia_times(gravity), IsNear((inertia.I * gravity).eval(), 1e-12));
  }
}

TEST_F(BodyOfPoints, HasTheMassMatrixAndGravityOfItsPoints) {
  for (int trial = 0; trial < 50; ++trial) {
    draw();
    const BodyInertia<double> inertia(p);
    Matrix<double, N, N> M = Matrix<double, N, N>::Zero();
    Vector<double, N> g = Vector<double, N>::Zero();
    for (const auto& [m, r] : points) {
      M += m * share(r).transpose() * share(r);
      g -= m * share(r).transpose() * gravity;
    }
    EXPECT_THAT(inertia.mass_matrix(body), IsNear(M, 1e-12 * M.norm()));
    EXPECT_THAT(inertia.gravity_torque(body, gravity), IsNear(g, 1e-12 * (1 + g.norm())));
  }
}

// The integral of (dr/dq)^T d/dt(dr/dq) over the mass.
TEST_F(BodyOfPoints, HasTheCoriolisMatrixOfItsPoints) {
  for (int trial = 0; trial < 50; ++trial) {
    draw();
    Matrix<double, N, N> C = Matrix<double, N, N>::Zero();
    for (const auto& [m, r] : points) C += m * share(r).transpose() * share_rate(r);
    EXPECT_THAT(BodyInertia<double>(p).coriolis_matrix(body), IsNear(C, 1e-12 * (1 + C.norm())));
  }
}

TEST_F(BodyOfPoints, IsFoundAmongTheColumnsOfALayout) {
  using Layout = ParameterLayout<Delta4, Limbs::individual>;
  const auto all = random_parameters<Layout>(random);
  const auto strut = body_inertia<Layout>(all, Body::strut, 2);
  const auto column = kInertialParameters * Layout::body(Body::strut, 2);
  EXPECT_EQ(strut.m, all(column));
  EXPECT_EQ(strut.mc, all.segment<3>(column + 1));
  EXPECT_EQ(strut.I(0, 2), all(column + 9));
  EXPECT_EQ(strut.I, strut.I.transpose());
}

}  // namespace
}  // namespace deltadyn
