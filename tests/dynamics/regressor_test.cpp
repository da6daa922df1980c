// The regressor against Lagrange's equations, for every type of robot, every body and every joint.

#include "deltadyn/dynamics/regressor.hpp"

#include <gtest/gtest.h>

#include "support/core_instances.hpp"
#include "support/matchers.hpp"
#include "support/oracle_of.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

template <class R>
class Regressor : public ::testing::Test {
 protected:
  template <class Layout>
  using Y = Matrix<double, R::kDrives, Layout::kColumns>;
  using Drives = Vector<double, R::kDrives>;

  /// A fresh robot in a fresh state.
  void draw() {
    geometry = random_geometry<R>(random);
    task = random_task<R>(random);
    ASSERT_EQ(motion_from_task(geometry, task.z, task.zd, task.zdd, motion), Status::ok);
  }

  template <class Layout>
  Drives oracle(const Vector<double, Layout::kColumns>& p) const {
    return to_vector<R::kDrives>(oracles::drive_torque(oracle_of(geometry), load_of<R, Layout>(p),
                                                       numbers(motion.posture.q), numbers(motion.qd),
                                                       numbers(motion.qdd), numbers(task.z)));
  }

  /// What rounding of the terms of Y p can do.
  template <class Layout>
  static double size(const Y<Layout>& y, const Vector<double, Layout::kColumns>& p) {
    return (y.cwiseAbs() * p.cwiseAbs()).maxCoeff();
  }

  template <Limbs kSharing>
  void expect_oracle_torque() {
    using Layout = ParameterLayout<R, kSharing>;
    for (int trial = 0; trial < 25; ++trial) {
      draw();
      const auto p = random_parameters<Layout>(random);
      Y<Layout> y;
      regressor<Layout>(geometry, motion, y);
      EXPECT_THAT((y * p).eval(), IsNear(oracle<Layout>(p), 1e-12 * size<Layout>(y, p))) << "trial " << trial;
    }
  }

  Random random{20240611};
  Geometry<double, R> geometry;
  RandomTask<R> task;
  Motion<double, R> motion;
};

using Robots = ::testing::Types<Delta3, LinearDelta3, Delta4, TurningPlate, Axis, LinearAxis>;
TYPED_TEST_SUITE(Regressor, Robots);

TYPED_TEST(Regressor, TimesSharedParametersIsTheOracleTorque) {
  this->template expect_oracle_torque<Limbs::shared>();
}

TYPED_TEST(Regressor, TimesIndividualParametersIsTheOracleTorque) {
  this->template expect_oracle_torque<Limbs::individual>();
}

// One column at a time, so that no two mistakes can hide each other; a single entry need not be a consistent body.
TYPED_TEST(Regressor, EachColumnIsTheOracleTorqueOfItsParameter) {
  using Layout = ParameterLayout<TypeParam, Limbs::individual>;
  this->draw();
  typename TestFixture::template Y<Layout> y;
  regressor<Layout>(this->geometry, this->motion, y);
  for (int k = 0; k < Layout::kColumns; ++k) {
    const Vector<double, Layout::kColumns> unit = Vector<double, Layout::kColumns>::Unit(k);
    const double scale = 1 + y.col(k).cwiseAbs().maxCoeff();
    EXPECT_THAT(y.col(k).eval(), IsNear(this->template oracle<Layout>(unit), 1e-11 * scale)) << "column " << k;
  }
}

TYPED_TEST(Regressor, SharedColumnsAreTheSumOfTheLimbs) {
  using Shared = ParameterLayout<TypeParam, Limbs::shared>;
  using Individual = ParameterLayout<TypeParam, Limbs::individual>;
  this->draw();
  typename TestFixture::template Y<Shared> shared;
  typename TestFixture::template Y<Individual> individual;
  regressor<Shared>(this->geometry, this->motion, shared);
  regressor<Individual>(this->geometry, this->motion, individual);
  const auto body = [](const auto& y, int b) {
    return y.template middleCols<kInertialParameters>(kInertialParameters * b).eval();
  };
  for (const Body kind : {Body::upper_arm, Body::strut}) {
    if (kind == Body::strut && !kHasPlate<TypeParam>) continue;
    auto sum = body(individual, Individual::body(kind, 0));
    for (int i = 1; i < TypeParam::kLimbs; ++i) sum += body(individual, Individual::body(kind, i));
    EXPECT_THAT(body(shared, Shared::body(kind, 0)), IsNear(sum, 1e-12 * (1 + sum.cwiseAbs().maxCoeff())))
        << name(kind);
  }
  constexpr int kHalves = TypeParam::kPlateTurns ? 1 : 0;  // these go with the limbs that they hold
  if constexpr (kHalves > 0) {
    const auto sum = (body(individual, Individual::body(Body::half_plate, 0)) +
                      body(individual, Individual::body(Body::half_plate, 1)))
                         .eval();
    EXPECT_THAT(body(shared, Shared::body(Body::half_plate, 0)), IsNear(sum, 1e-12 * (1 + sum.cwiseAbs().maxCoeff())));
  }
  constexpr int kRest = Shared::kColumns - kInertialParameters * (Shared::kLimbSets + Shared::kStruts + kHalves);
  EXPECT_EQ(shared.template rightCols<kRest>(), individual.template rightCols<kRest>());
}

TYPED_TEST(Regressor, WritesEveryEntry) {
  using Layout = ParameterLayout<TypeParam, Limbs::shared>;
  this->draw();
  typename TestFixture::template Y<Layout> clean, dirty;
  clean.setZero();
  dirty.setConstant(1e300);
  regressor<Layout>(this->geometry, this->motion, clean);
  regressor<Layout>(this->geometry, this->motion, dirty);
  EXPECT_EQ(clean, dirty);
}

TYPED_TEST(Regressor, IsTheSameInSinglePrecision) {
  using Layout = ParameterLayout<TypeParam, Limbs::shared>;
  for (int trial = 0; trial < 20; ++trial) {
    this->draw();
    Motion<float, TypeParam> coarse_motion;
    const auto coarse = cast_geometry<float>(this->geometry);
    ASSERT_EQ(motion_from_task<float>(coarse, this->task.z.template cast<float>(), this->task.zd.template cast<float>(),
                                      this->task.zdd.template cast<float>(), coarse_motion),
              Status::ok);
    typename TestFixture::template Y<Layout> y;
    Matrix<float, TypeParam::kDrives, Layout::kColumns> y_float;
    regressor<Layout>(this->geometry, this->motion, y);
    regressor<Layout>(coarse, coarse_motion, y_float);
    for (int k = 0; k < Layout::kColumns; ++k) {
      // Coulomb columns jump with the sign of a rate; rates here are far from zero beside float's resolution.
      const double scale = 1 + y.col(k).cwiseAbs().maxCoeff();
      EXPECT_THAT(y_float.col(k).eval(), IsNear(y.col(k).eval(), 3e-4 * scale))
          << "column " << k << ", trial " << trial;
    }
  }
}

// A strut's inertia about its own axis does show: the strut turns about y of the limb and then about its own z.
TEST(RegressorOfDelta3, HasNoColumnForThePlatesTurning) {
  using Layout = ParameterLayout<Delta3, Limbs::shared>;
  Random random(5);
  const auto geometry = random_geometry<Delta3>(random);
  const auto task = random_task<Delta3>(random);
  Motion<double, Delta3> motion;
  ASSERT_EQ(motion_from_task(geometry, task.z, task.zd, task.zdd, motion), Status::ok);
  Matrix<double, 3, Layout::kColumns> y;
  regressor<Layout>(geometry, motion, y);
  const int platform = kInertialParameters * Layout::body(Body::platform, 0);
  EXPECT_GT(y.col(platform).cwiseAbs().minCoeff(), 0);
  EXPECT_EQ(y.middleCols(platform + 1, 9).cwiseAbs().maxCoeff(), 0);
  EXPECT_GT(y.col(kInertialParameters * Layout::body(Body::strut, 0) + 4).cwiseAbs().maxCoeff(), 0);
}

}  // namespace
}  // namespace deltadyn
