#include "deltadyn/dynamics/equations_of_motion.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "deltadyn/dynamics/inverse_dynamics_derivatives.hpp"

#include "support/drawn_motion.hpp"
#include "support/matchers.hpp"
#include "support/oracle_of.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

constexpr int kStates = 10000;

template <class R>
class Equations : public ::testing::Test {
 protected:
  DrawnMotion<R> drawn{51};
};
TYPED_TEST_SUITE(Equations, AllRobots);

/// dM/dt along the motion, by dual numbers through M(q).
template <class R>
Matrix<double, R::kDrives, R::kDrives> mass_matrix_rate(const DrawnMotion<R>& drawn) {
  constexpr int N = R::kDrives;
  using Layout = typename DrawnMotion<R>::Layout;
  using Number = Dual<double, N>;
  const auto geometry = cast_geometry<Number>(drawn.geometry);
  Posture<Number, R> nearby;
  EXPECT_EQ(posture_with_slopes(geometry, drawn.motion.posture, nearby), Status::ok);
  const Matrix<Number, N, N> M = mass_matrix<Layout, Number, R>(geometry, nearby, drawn.p.template cast<Number>());
  Matrix<double, N, N> rate;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) rate(i, j) = M(i, j).slope.dot(drawn.motion.qd);
  }
  return rate;
}

TYPED_TEST(Equations, HoldWhatTheControllersOfThePaperNeed) {
  using R = TypeParam;
  using Layout = typename DrawnMotion<R>::Layout;
  auto& d = this->drawn;
  double asymmetry = 0, skewness = 0, torque = 0;
  for (int state = 0; state < kStates; ++state) {
    d.next();
    const auto terms = equations_of_motion<Layout>(d.geometry, d.motion, d.p);
    asymmetry = std::max(asymmetry, (terms.M - terms.M.transpose()).norm() / terms.M.norm());
    ASSERT_EQ(terms.M.llt().info(), Eigen::Success) << "state " << state;
    const auto rate = mass_matrix_rate(d);
    const typename DrawnMotion<R>::Square N = rate - 2 * terms.C;
    skewness = std::max(skewness, (N + N.transpose()).norm() / (1e-6 + rate.norm() + terms.C.norm()));
    const auto tau = inverse_dynamics<Layout>(d.geometry, d.motion, d.p);
    const typename DrawnMotion<R>::Drives sum = terms.M * d.motion.qdd + terms.C * d.motion.qd + terms.g + terms.f;
    torque = std::max(torque, (sum - tau).norm() / (terms.M.norm() * d.motion.qdd.norm() + tau.norm()));
  }
  EXPECT_EQ(asymmetry, 0);
  EXPECT_LT(skewness, 1e-9);
  EXPECT_LT(torque, 1e-9);
}

TYPED_TEST(Equations, HoldInTaskCoordinates) {
  using R = TypeParam;
  using Layout = typename DrawnMotion<R>::Layout;
  using Drives = typename DrawnMotion<R>::Drives;
  auto& d = this->drawn;
  double power = 0, torque = 0, skewness = 0, energy = 0;
  for (int state = 0; state < kStates; ++state) {
    d.next();
    const auto terms = equations_of_motion<Layout>(d.geometry, d.motion, d.p);
    EquationsOfMotion<double, R::kDrives> task;
    ASSERT_EQ(equations_in_task(d.geometry, d.motion, terms, task), Status::ok);
    EXPECT_EQ(task.M, task.M.transpose());
    ASSERT_EQ(task.M.llt().info(), Eigen::Success) << "state " << state;
    const auto& m = d.motion;
    // The force on the plate that does what the drives do: tau = J^T F.
    const Drives F = task.M * m.zdd + task.C * m.zd + task.g + task.f;
    const Drives tau = inverse_dynamics<Layout>(d.geometry, m, d.p);
    const auto J = task_jacobian(m.posture);
    torque =
        std::max(torque, (J.transpose() * F - tau).norm() / ((J.transpose() * task.M * m.zdd).norm() + tau.norm()));
    power =
        std::max(power, std::abs(F.dot(m.zd) - tau.dot(m.qd)) / (F.norm() * m.zd.norm() + tau.norm() * m.qd.norm()));
    energy = std::max(energy, std::abs(m.zd.dot(task.M * m.zd) - m.qd.dot(terms.M * m.qd)) / m.qd.dot(terms.M * m.qd));
    // d/dt of J^-T M J^-1 by the product rule, with the rate of M by dual numbers.
    const auto J_d = task_jacobian_rate(jacobian_rates(d.geometry, m));
    const typename DrawnMotion<R>::Square inverse = J.inverse(), turn = J_d * inverse;
    const typename DrawnMotion<R>::Square rate =
        inverse.transpose() * mass_matrix_rate(d) * inverse - turn.transpose() * task.M - task.M * turn;
    const typename DrawnMotion<R>::Square N = rate - 2 * task.C;
    skewness = std::max(skewness, (N + N.transpose()).norm() / (1e-6 + rate.norm() + task.C.norm()));
  }
  EXPECT_LT(torque, 1e-9);
  EXPECT_LT(power, 1e-9);
  EXPECT_LT(energy, 1e-9);
  EXPECT_LT(skewness, 1e-9);
}

// The Christoffel symbols of M are the one C that an observer of the momentum and the derivatives by qd need.
TYPED_TEST(Equations, HaveTheChristoffelSymbolsAsCoriolisMatrix) {
  constexpr int N = TypeParam::kDrives;
  using Layout = typename DrawnMotion<TypeParam>::Layout;
  using Number = Dual<double, N>;
  auto& d = this->drawn;
  for (int state = 0; state < 100; ++state) {
    d.next();
    const auto geometry = cast_geometry<Number>(d.geometry);
    Posture<Number, TypeParam> nearby;
    ASSERT_EQ(posture_with_slopes(geometry, d.motion.posture, nearby), Status::ok);
    const Matrix<Number, N, N> M =
        mass_matrix<Layout, Number, TypeParam>(geometry, nearby, d.p.template cast<Number>());
    Matrix<double, N, N> C = Matrix<double, N, N>::Zero();
    double size = 1e-6;
    for (int i = 0; i < N; ++i) {
      for (int j = 0; j < N; ++j) {
        for (int k = 0; k < N; ++k) {
          C(i, j) += 0.5 * (M(i, j).slope(k) + M(i, k).slope(j) - M(j, k).slope(i)) * d.motion.qd(k);
          size += std::abs(M(i, j).slope(k) * d.motion.qd(k));
        }
      }
    }
    EXPECT_THAT(equations_of_motion<Layout>(d.geometry, d.motion, d.p).C, IsNear(C, 1e-11 * size)) << "state " << state;
  }
}

TYPED_TEST(Equations, HaveTheGradientOfThePotentialAsGravity) {
  constexpr int N = TypeParam::kDrives;
  using Layout = typename DrawnMotion<TypeParam>::Layout;
  using Number = Dual<double, N>;
  auto& d = this->drawn;
  double worst = 0;
  for (int state = 0; state < kStates; ++state) {
    d.next();
    const auto geometry = cast_geometry<Number>(d.geometry);
    Posture<Number, TypeParam> nearby;
    ASSERT_EQ(posture_with_slopes(geometry, d.motion.posture, nearby), Status::ok);
    const Number V = potential_energy<Layout, Number, TypeParam>(geometry, nearby, d.p.template cast<Number>());
    const auto g = equations_of_motion<Layout>(d.geometry, d.motion, d.p).g;
    worst = std::max(worst, (g - V.slope).norm() / (1e-3 + g.norm()));
    EXPECT_NEAR(V.value, (potential_energy<Layout>(d.geometry, d.motion.posture, d.p)),
                1e-11 * (1 + std::abs(V.value)));
  }
  EXPECT_LT(worst, 1e-8);
}

TYPED_TEST(Equations, HaveTheEnergiesOfTheDrawing) {
  using Layout = typename DrawnMotion<TypeParam>::Layout;
  auto& d = this->drawn;
  for (int state = 0; state < 100; ++state) {
    d.next();
    const auto mechanism = oracle_of(d.geometry);
    const auto load = load_of<TypeParam, Layout>(d.p);
    const oracles::State<oracles::Real> at{numbers(d.motion.posture.q), numbers(d.motion.qd)};
    const double T = static_cast<double>(oracles::kinetic_energy(mechanism, load, at, numbers(d.task.z)));
    const double V =
        static_cast<double>(oracles::potential_energy(mechanism, load, numbers(d.motion.posture.q), numbers(d.task.z)));
    EXPECT_NEAR((kinetic_energy<Layout>(d.geometry, d.motion, d.p)), T, 1e-11 * T);
    EXPECT_NEAR((potential_energy<Layout>(d.geometry, d.motion.posture, d.p)), V, 1e-11 * (1 + std::abs(V)));
    const auto M = equations_of_motion<Layout>(d.geometry, d.motion, d.p).M;
    EXPECT_NEAR(0.5 * d.motion.qd.dot(M * d.motion.qd), T, 1e-11 * T);
  }
}

TYPED_TEST(Equations, AreTheSameInSinglePrecision) {
  using R = TypeParam;
  using Layout = typename DrawnMotion<R>::Layout;
  auto& d = this->drawn;
  for (int state = 0; state < 100; ++state) {
    d.next();
    const auto coarse = cast_geometry<float>(d.geometry);
    Motion<float, R> motion;
    ASSERT_EQ(assemble_posture<float>(coarse, d.motion.posture.q.template cast<float>(),
                                      d.task.z.template cast<float>(), motion.posture),
              Status::ok);
    set_drive_rates<float, R>(coarse, d.motion.qd.template cast<float>(), d.motion.qdd.template cast<float>(), motion);
    const auto fine = equations_of_motion<Layout>(d.geometry, d.motion, d.p);
    const auto terms = equations_of_motion<Layout, float, R>(coarse, motion, d.p.template cast<float>());
    const double momentum = fine.M.norm() * d.motion.qd.norm();
    EXPECT_THAT(terms.M, IsNear(fine.M, 1e-4 * fine.M.norm()));
    EXPECT_THAT(terms.C, IsNear(fine.C, 1e-4 * (momentum + fine.C.norm())));
    EXPECT_THAT(terms.g, IsNear(fine.g, 1e-4 * (1 + d.p.norm() * d.geometry.gravity.norm())));
    EXPECT_THAT(terms.f, IsNear(fine.f, 1e-4 * (1 + fine.f.norm())));
  }
}

}  // namespace
}  // namespace deltadyn
