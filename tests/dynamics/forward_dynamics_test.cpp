#include "deltadyn/dynamics/forward_dynamics.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "deltadyn/dynamics/equations_of_motion.hpp"

#include "support/drawn_motion.hpp"
#include "support/matchers.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

template <class R>
class ForwardDynamics : public ::testing::Test {
 protected:
  DrawnMotion<R> drawn{41};
};
TYPED_TEST_SUITE(ForwardDynamics, AllRobots);

TYPED_TEST(ForwardDynamics, UndoesInverseDynamicsOverTenThousandStates) {
  using Layout = typename DrawnMotion<TypeParam>::Layout;
  using Drives = typename DrawnMotion<TypeParam>::Drives;
  auto& d = this->drawn;
  double worst = 0;
  for (int trial = 0; trial < 10000; ++trial) {
    d.next();
    const Drives tau = inverse_dynamics<Layout>(d.geometry, d.motion, d.p);
    Drives qdd = Drives::Constant(std::numeric_limits<double>::quiet_NaN());
    ASSERT_EQ((forward_dynamics<Layout, double, TypeParam>(d.geometry, d.motion.posture, d.motion.qd, tau, d.p, qdd)),
              Status::ok);
    const double error = (qdd - d.motion.qdd).norm() / d.motion.qdd.norm();
    worst = error > worst || error != error ? error : worst;
  }
  EXPECT_LT(worst, 1e-9);
}

TYPED_TEST(ForwardDynamics, DoesSoInSinglePrecision) {
  using Layout = typename DrawnMotion<TypeParam>::Layout;
  using Floats = Vector<float, TypeParam::kDrives>;
  auto& d = this->drawn;
  for (int trial = 0; trial < 100; ++trial) {
    d.next();
    const auto coarse = cast_geometry<float>(d.geometry);
    const Floats z = d.task.z.template cast<float>(), zd = d.task.zd.template cast<float>(),
                 zdd = d.task.zdd.template cast<float>();
    Motion<float, TypeParam> state;
    ASSERT_EQ(motion_from_task(coarse, z, zd, zdd, state), Status::ok);
    const Vector<float, Layout::kColumns> load = d.p.template cast<float>();
    const Floats tau = inverse_dynamics<Layout>(coarse, state, load);
    Floats qdd;
    ASSERT_EQ((forward_dynamics<Layout, float, TypeParam>(coarse, state.posture, state.qd, tau, load, qdd)),
              Status::ok);
    EXPECT_THAT(qdd, IsNear(state.qdd, 1e-3 * static_cast<double>(state.qdd.norm()))) << "trial " << trial;
  }
}

TYPED_TEST(ForwardDynamics, RefusesWhatHasNoAcceleration) {
  using Layout = typename DrawnMotion<TypeParam>::Layout;
  using Drives = typename DrawnMotion<TypeParam>::Drives;
  auto& d = this->drawn;
  d.next();
  const Drives before = Drives::Constant(42), tau = Drives::Ones();
  Drives qdd = before, bad = tau;
  const auto run = [&](const Drives& torque) {
    return forward_dynamics<Layout, double, TypeParam>(d.geometry, d.motion.posture, d.motion.qd, torque, d.p, qdd);
  };
  bad(0) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(run(bad), Status::out_of_range);
  d.p.template head<kInertialParameters * Layout::kBodies>() *= -1000;  // negative masses that outweigh the rotors
  EXPECT_EQ(run(tau), Status::out_of_range);
  EXPECT_EQ(qdd, before);
}

/// The types whose forward kinematics is at hand, to be simulated.
template <class R>
class Simulation : public ::testing::Test {};
using SimulatedRobots = ::testing::Types<Delta3, LinearDelta3, Delta4, Axis, LinearAxis>;
TYPED_TEST_SUITE(Simulation, SimulatedRobots);

// What the drives give is in the energy of the bodies or went into viscous friction, over 0.3 s of a fast motion. The
// work is integrated beside the motion, by the same method of Runge and Kutta.
TYPED_TEST(Simulation, BalancesTheEnergy) {
  using R = TypeParam;
  using Layout = ParameterLayout<R, Limbs::individual>;
  using Drives = Vector<double, R::kDrives>;
  Random random(43);
  const auto geometry = random_geometry<R>(random);
  const auto task = random_task<R>(random);
  auto p = random_parameters<Layout>(random);
  // A jump would spoil the method
  for (int joint = 0; joint < Layout::kFrictionJoints; ++joint) p(Layout::coulomb(joint)) = 0;
  struct State {
    Drives q, qd;
    double work;
  };
  State x{Drives::Zero(), Drives::Zero(), 0};
  ASSERT_EQ(inverse_kinematics(geometry, task.z, x.q), Status::ok);
  const Drives home = x.q;
  double heat_rate = 0;
  const auto slope = [&](const State& at, double t) {
    Motion<double, R> motion;
    const Drives wish = -400 * (at.q - home) - 2 * at.qd + 60 * Drives::Constant(std::sin(25 * t));
    EXPECT_EQ((motion_from_drives<double, R>(geometry, at.q, at.qd, Drives::Zero(), motion)), Status::ok);
    const Drives tau =
        mass_matrix<Layout>(geometry, motion.posture, p) * wish + equations_of_motion<Layout>(geometry, motion, p).g;
    Drives qdd = Drives::Zero();
    EXPECT_EQ((forward_dynamics<Layout, double, R>(geometry, motion.posture, at.qd, tau, p, qdd)), Status::ok);
    heat_rate = at.qd.dot(equations_of_motion<Layout>(geometry, motion, p).f);
    return State{at.qd, qdd, at.qd.dot(tau) - heat_rate};
  };
  const auto step = [](const State& at, const State& d, double h) {
    return State{at.q + h * d.q, at.qd + h * d.qd, at.work + h * d.work};
  };
  const auto energy = [&] {
    Motion<double, R> motion;
    EXPECT_EQ((motion_from_drives<double, R>(geometry, x.q, x.qd, Drives::Zero(), motion)), Status::ok);
    return kinetic_energy<Layout>(geometry, motion, p) + potential_energy<Layout>(geometry, motion.posture, p);
  };
  const double start = energy(), h = 1e-4;
  double exchanged = 0, heat = 0, worst = 0;
  for (int k = 0; k < 3000; ++k) {
    const double t = k * h;
    const State d1 = slope(x, t);
    exchanged += h * std::abs(d1.work);
    heat += h * heat_rate;
    const State d2 = slope(step(x, d1, h / 2), t + h / 2), d3 = slope(step(x, d2, h / 2), t + h / 2),
                d4 = slope(step(x, d3, h), t + h);
    for (const auto& [d, share] : {std::pair{d1, h / 6}, {d2, h / 3}, {d3, h / 3}, {d4, h / 6}}) x = step(x, d, share);
    worst = std::max(worst, std::abs(energy() - start - x.work));
  }
  EXPECT_GT(exchanged, 1.0);  // [J]
  EXPECT_GT(std::abs(heat), 0.01);
  EXPECT_LT(worst, 1e-9 * exchanged);
}

}  // namespace
}  // namespace deltadyn
