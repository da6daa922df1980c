#include "deltadyn/dynamics/forward_dynamics.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "support/matchers.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

template <class R>
class ForwardDynamics : public ::testing::Test {
 protected:
  using AllColumns = ParameterLayout<R, Limbs::individual>;
  using DriveVector = Vector<double, R::kDrives>;

  void draw() {
    geometry = random_geometry<R>(random);
    task = random_task<R>(random);
    p = random_parameters<AllColumns>(random);
    ASSERT_EQ(motion_from_task(geometry, task.z, task.zd, task.zdd, motion), Status::ok);
  }

  Random random{41};
  Geometry<double, R> geometry;
  RandomTask<R> task;
  Motion<double, R> motion;
  Vector<double, AllColumns::kColumns> p;
};

using Robots = ::testing::Types<Delta3, LinearDelta3, Delta4, TurningPlate, Axis, LinearAxis>;
TYPED_TEST_SUITE(ForwardDynamics, Robots);

TYPED_TEST(ForwardDynamics, UndoesInverseDynamicsOverTenThousandStates) {
  using Layout = typename TestFixture::AllColumns;
  using Drives = typename TestFixture::DriveVector;
  double worst = 0;
  for (int trial = 0; trial < 10000; ++trial) {
    this->draw();
    const Drives tau = inverse_dynamics<Layout>(this->geometry, this->motion, this->p);
    Drives qdd = Drives::Constant(std::numeric_limits<double>::quiet_NaN());
    ASSERT_EQ((forward_dynamics<Layout, double, TypeParam>(this->geometry, this->motion.posture, this->motion.qd, tau, this->p,
                                                           qdd)),
              Status::ok);
    const double error = (qdd - this->motion.qdd).norm() / this->motion.qdd.norm();
    worst = error > worst || error != error ? error : worst;
  }
  EXPECT_LT(worst, 1e-9);
}

TYPED_TEST(ForwardDynamics, DoesSoInSinglePrecision) {
  using Layout = typename TestFixture::AllColumns;
  using Floats = Vector<float, TypeParam::kDrives>;
  for (int trial = 0; trial < 100; ++trial) {
    this->draw();
    const auto coarse = cast_geometry<float>(this->geometry);
    const Floats z = this->task.z.template cast<float>(), zd = this->task.zd.template cast<float>(),
                 zdd = this->task.zdd.template cast<float>();
    Motion<float, TypeParam> state;
    ASSERT_EQ(motion_from_task(coarse, z, zd, zdd, state), Status::ok);
    const Vector<float, Layout::kColumns> load = this->p.template cast<float>();
    const Floats tau = inverse_dynamics<Layout>(coarse, state, load);
    Floats qdd;
    ASSERT_EQ((forward_dynamics<Layout, float, TypeParam>(coarse, state.posture, state.qd, tau, load, qdd)), Status::ok);
    EXPECT_THAT(qdd, IsNear(state.qdd, 1e-3 * static_cast<double>(state.qdd.norm()))) << "trial " << trial;
  }
}

TYPED_TEST(ForwardDynamics, RefusesWhatHasNoAcceleration) {
  using Layout = typename TestFixture::AllColumns;
  using Drives = typename TestFixture::DriveVector;
  this->draw();
  const Drives before = Drives::Constant(42), tau = Drives::Ones();
  Drives qdd = before, bad = tau;
  const auto run = [&](const Drives& torque) {
    return forward_dynamics<Layout, double, TypeParam>(this->geometry, this->motion.posture, this->motion.qd, torque, this->p,
                                                       qdd);
  };
  bad(0) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(run(bad), Status::out_of_range);
  this->p.template head<kInertialParameters * Layout::kBodies>() *= -1000;  // negative masses that outweigh the rotors
  EXPECT_EQ(run(tau), Status::out_of_range);
  EXPECT_EQ(qdd, before);
}

}  // namespace
}  // namespace deltadyn
