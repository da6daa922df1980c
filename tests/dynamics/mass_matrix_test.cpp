#include "deltadyn/dynamics/mass_matrix.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "deltadyn/dynamics/inverse_dynamics.hpp"

#include "support/core_instances.hpp"
#include "support/matchers.hpp"
#include "support/oracle_of.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

template <class R>
class MassMatrix : public ::testing::Test {
 protected:
  static constexpr int N = R::kDrives;
  using Drives = Vector<double, N>;

  void draw() {
    geometry = random_geometry<R>(random);
    task = random_task<R>(random);
    ASSERT_EQ(motion_from_task(geometry, task.z, task.zd, task.zdd, motion), Status::ok);
  }

  template <Limbs kSharing>
  void expect_columns_of_inverse_dynamics() {
    using Layout = ParameterLayout<R, kSharing>;
    for (int trial = 0; trial < 50; ++trial) {
      draw();
      const auto p = random_parameters<Layout>(random);
      const Matrix<double, N, N> M = mass_matrix<Layout>(geometry, motion.posture, p);
      const auto torque = [&](const Drives& qdd) {
        set_drive_rates<double, R>(geometry, task.zd, qdd, motion);  // any velocity will do, it cancels
        return inverse_dynamics<Layout>(geometry, motion, p);
      };
      const Drives still = torque(Drives::Zero());
      Matrix<double, N, N> columns;
      for (int j = 0; j < N; ++j) columns.col(j) = torque(Drives::Unit(j)) - still;
      EXPECT_THAT(columns, IsNear(M, 1e-12 * (M.norm() + still.norm()))) << "trial " << trial;
    }
  }

  Random random{3};
  Geometry<double, R> geometry;
  RandomTask<R> task;
  Motion<double, R> motion;
};

using Robots = ::testing::Types<Delta3, LinearDelta3, Delta4, TurningPlate, Axis, LinearAxis>;
TYPED_TEST_SUITE(MassMatrix, Robots);

TYPED_TEST(MassMatrix, HasTheColumnsOfInverseDynamics) {
  this->template expect_columns_of_inverse_dynamics<Limbs::shared>();
  this->template expect_columns_of_inverse_dynamics<Limbs::individual>();
}

TYPED_TEST(MassMatrix, IsSymmetricAndPositiveDefiniteForConsistentParameters) {
  using Layout = ParameterLayout<TypeParam, Limbs::individual>;
  for (int trial = 0; trial < 500; ++trial) {
    this->draw();
    auto p = random_parameters<Layout>(this->random);
    p.template segment<TypeParam::kDrives>(Layout::kRotorInertia).setZero();  // the bodies alone must do
    const auto M = mass_matrix<Layout>(this->geometry, this->motion.posture, p);
    EXPECT_EQ(M, M.transpose());
    EXPECT_GT(
        (Eigen::SelfAdjointEigenSolver<Matrix<double, TypeParam::kDrives, TypeParam::kDrives>>(M).eigenvalues()(0)), 0);
  }
}

TYPED_TEST(MassMatrix, IsTheSecondDerivativeOfTheKineticEnergy) {
  using Layout = ParameterLayout<TypeParam, Limbs::individual>;
  constexpr int kSize = TypeParam::kDrives;
  for (int trial = 0; trial < 20; ++trial) {
    this->draw();
    const auto p = random_parameters<Layout>(this->random);
    Matrix<double, kSize, kSize> expected;
    for (int i = 0; i < kSize; ++i) {
      for (int j = 0; j < kSize; ++j) {
        expected(i, j) = static_cast<double>(oracles::mass_matrix_entry(
            oracle_of(this->geometry), load_of<TypeParam, Layout>(p), numbers(this->motion.posture.q),
            static_cast<std::size_t>(i), static_cast<std::size_t>(j), numbers(this->task.z)));
      }
    }
    EXPECT_THAT((mass_matrix<Layout>(this->geometry, this->motion.posture, p)),
                IsNear(expected, 1e-12 * expected.norm()));
  }
}

TYPED_TEST(MassMatrix, IsTheSameInSinglePrecision) {
  using Layout = ParameterLayout<TypeParam, Limbs::shared>;
  this->draw();
  const auto p = random_parameters<Layout>(this->random);
  const auto coarse = cast_geometry<float>(this->geometry);
  Posture<float, TypeParam> posture;
  ASSERT_EQ(assemble_posture<float>(coarse, this->motion.posture.q.template cast<float>(),
                                    this->task.z.template cast<float>(), posture),
            Status::ok);
  const auto M = mass_matrix<Layout>(this->geometry, this->motion.posture, p);
  EXPECT_THAT((mass_matrix<Layout, float, TypeParam>(coarse, posture, p.template cast<float>())),
              IsNear(M, 1e-4 * M.norm()));
}

}  // namespace
}  // namespace deltadyn
