// The oracles against what is known without them: text-book pendulum, finite differences, a hand-made loop.

#include "oracles/lagrange.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace oracles {
namespace {

using V = Vec3<Real>;

Mechanism axis(bool prismatic) {
  Mechanism m;
  m.prismatic = prismatic;
  m.gravity = V(0, 0, -9.81L);
  m.limbs.push_back(
      {0.4L, V(0.1L, 0.2L, 0.3L), prismatic ? V(0, 0, 1) : V(0, 1, 0), V(0.5L, 0, 0), 0, 0, V(0, 0, 0), 0});
  return m;
}

Mechanism delta() {
  Mechanism m;
  m.gravity = V(0, 0, -9.81L);
  m.parts.push_back({V(0, 0, 0), V(0, 0, 0), V(0, 0, 0), 0});
  m.bar_top = V(0.01L, 0.02L, 0.03L);
  m.bar_bottom = V(0.02L, -0.01L, 0.04L);
  for (int i = 0; i < 3; ++i) {
    const Real a = 2.1L * i;
    m.limbs.push_back({a, turn<Real>(2, a) * V(0.2L, 0, 0), V(0, 1, 0), V(0.4L, 0, 0), 1.0L, 0.1L,
                       turn<Real>(2, a) * V(0.05L, 0, 0), 0});
  }
  return m;
}

TEST(Dual, GivesFirstAndMixedSecondDerivatives) {
  const Real x = 0.7L;
  const auto f = [](const auto& t) {
    using std::cos;
    using std::sin;
    using std::sqrt;
    return sin(t) * sqrt(t) / cos(t);
  };
  const auto first = f(Dual<Real>(x, 1));
  const auto second = f(Dual<Dual<Real>>(Dual<Real>(x, 1), Dual<Real>(1, 0)));
  const Real h = 1e-5L;
  EXPECT_NEAR(static_cast<double>(first.slope), static_cast<double>((f(x + h) - f(x - h)) / (2 * h)), 1e-9);
  EXPECT_NEAR(static_cast<double>(second.slope.slope), static_cast<double>((f(x + h) - 2 * f(x) + f(x - h)) / (h * h)),
              1e-8);
  EXPECT_EQ(second.value.slope, second.slope.value);
}

TEST(DriveTorque, IsThatOfAPendulum) {
  // Arm turned down by q: torque I qdd - g (mcx cos q + mcz sin q), plus what rubs.
  Load load{{{2, 0.3L, 0.1L, 0.2L, 0.5L, 0.7L, 0.6L, 0.05L, 0.02L, -0.03L}}, {1.5L}, {2.5L}, {0.25L}, {0.125L}};
  const Real q = 0.3L, qd = -2, qdd = 5;
  const Real expected = 0.95L * qdd - 9.81L * (0.3L * std::cos(q) + 0.2L * std::sin(q)) - 1.5L * 2 - 2.5L + 0.125L;
  // z of the point (mcx, mcz) turned down by q about y is -mcx sin q + mcz cos q
  const Real torque = drive_torque(axis(false), load, {q}, {qd}, {qdd}, {})[0];
  EXPECT_NEAR(static_cast<double>(torque), static_cast<double>(expected), 1e-14);
}

TEST(DriveTorque, IsThatOfALift) {
  Load load{{{2, 0.3L, 0.1L, 0.2L, 0.5L, 0.7L, 0.6L, 0.05L, 0.02L, -0.03L}}, {0}, {0}, {0.5L}, {0}};
  EXPECT_NEAR(static_cast<double>(drive_torque(axis(true), load, {0.2L}, {1}, {3}, {})[0]), 2.5 * 3 + 2 * 9.81, 1e-14);
}

TEST(Plate, ClosesTheLoopsWithItsDerivatives) {
  const Mechanism m = delta();
  const Numbers q = {0.3L, -0.2L, 0.1L}, guess = {0, 0, -0.8L};
  const Real h = 1e-5L;
  std::vector<Dual<Dual<Real>>> moving;
  const Numbers qd = {1, -2, 0.5L};
  for (std::size_t k = 0; k < 3; ++k) moving.push_back({Dual<Real>(q[k], qd[k]), Dual<Real>(qd[k], 0)});
  const auto along = [&](Real t) {
    return plate(m, Numbers{q[0] + t * qd[0], q[1] + t * qd[1], q[2] + t * qd[2]}, guess);
  };
  const auto y = plate(m, moving, guess);
  const auto before = along(-h), now = along(0), after = along(h);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LT(std::abs(loop_error(m, k, q[k], now)), 1e-17L);
    EXPECT_NEAR(static_cast<double>(y[k].slope.value), static_cast<double>((after[k] - before[k]) / (2 * h)), 1e-8);
    EXPECT_NEAR(static_cast<double>(y[k].slope.slope),
                static_cast<double>((after[k] - 2 * now[k] + before[k]) / (h * h)), 1e-7);
  }
}

TEST(Plate, RefusesWhatDoesNotClose) {
  Mechanism m = delta();
  for (Limb& limb : m.limbs) limb.strut = 0.2L;
  EXPECT_THROW((void)plate(m, Numbers{0, 0, 0}, {0, 0, -0.8L}), std::runtime_error);
}

TEST(Poses, AreRotationsThatHangTogether) {
  Mechanism m = delta();
  m.has_bar = true;
  const Numbers q = {0.3L, -0.2L, 0.1L, 1.1L};
  const auto bodies = poses(m, q, {0, 0, -0.8L});
  ASSERT_EQ(bodies.size(), 13U);
  for (const auto& body : bodies) {
    EXPECT_LT((body.R * body.R.transpose() - Mat3<Real>::Identity()).cwiseAbs().maxCoeff(), 1e-17L);
    EXPECT_NEAR(static_cast<double>(body.R.determinant()), 1, 1e-15);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& left = bodies[3 * i + 1];
    const auto& right = bodies[3 * i + 2];
    EXPECT_LT((left.R - right.R).cwiseAbs().maxCoeff(), 1e-17L);  // a parallelogram
    EXPECT_NEAR(static_cast<double>((left.p - right.p).norm()), 0.1, 1e-15);
  }
  // From the lower joint straight up along the bar to the upper joint.
  const Real length = bar_length(m, plate(m, q, {0, 0, -0.8L}));
  EXPECT_LT((bodies[12].p + length * bodies[12].R.col(2) - bodies[11].p).norm(), 1e-17L);
}

TEST(DriveRoots, FindsBothElbows) {
  const Mechanism m = delta();
  const Numbers y = {0.05L, 0.02L, -0.8L};
  const auto roots = drive_roots(m, 0, y, -3.14159265L, 3.14159265L);
  ASSERT_EQ(roots.size(), 2U);
  EXPECT_LT(std::abs(loop_error(m, 0, roots[0], y)), 1e-17L);
  EXPECT_LT(std::abs(loop_error(m, 0, roots[1], y)), 1e-17L);
}

}  // namespace
}  // namespace oracles
