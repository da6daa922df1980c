#include "deltadyn/simulation/plant.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <numbers>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "identification/synthetic_log.hpp"
#include "simulation/effect_of.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using testing_support::axis_description;
using testing_support::delta_description;
using testing_support::delta_truth;
using testing_support::effect_of;

constexpr double kMass = 2, kViscous = 0.8, kCoulomb = 3;

/// A carriage on a rail: everything about it is known on paper.
Plant carriage(double viscous = kViscous, double coulomb = kCoulomb, const std::vector<Effect>& effects = {},
               const PlantOptions& options = {}) {
  const Eigen::Vector3d p(kMass, viscous, coulomb);
  return Plant(axis_description(DriveKind::prismatic), {"upper_arm.m", "drive1.viscous", "drive1.coulomb"}, p, effects,
               options);
}

DriveVector one(double value) {
  return DriveVector::Constant(1, value);
}

TEST(Plant, ASlidingCarriageStopsWhereItMustAndStaysThereExactly) {
  Plant plant = carriage();
  const double v0 = 1.5;
  plant.start(one(0), one(v0));
  plant.command(one(0));
  // m v' = -d v - c: v = (v0 + c/d) exp(-d t/m) - c/d.
  const double rest = kMass / kViscous * std::log(1 + v0 * kViscous / kCoulomb);
  const double way = kMass / kViscous * v0 - kCoulomb / kViscous * rest;
  for (int k = 0; k < 1500; ++k) plant.advance(1e-3);
  EXPECT_EQ(plant.qd()(0), 0.0);
  EXPECT_NEAR(plant.q()(0), way, 1e-10);
  EXPECT_EQ(plant.directions()[0], 0);
  EXPECT_EQ(plant.counts().reversals, 1);
  EXPECT_NEAR(plant.counts().stuck_s, 1.5 - rest, 1e-9);
  const double stopped = plant.q()(0);
  for (const double push : {2.9, -2.9, 0.0, 2.999}) {
    plant.command(one(push));
    plant.advance(0.1);
    EXPECT_EQ(plant.q()(0), stopped);
    EXPECT_EQ(plant.qdd()(0), 0.0);
  }
  plant.command(one(3.1));
  EXPECT_NEAR(plant.qdd()(0), 0.1 / kMass, 1e-12);
}

TEST(Plant, BreaksLooseInTheMiddleOfAPeriodWhenTheTorqueGetsThere) {
  PlantOptions options;
  options.current_lag_s = 0.05;
  Plant plant = carriage(0, kCoulomb, {}, options);
  plant.start(one(0), one(0));
  plant.command(one(0));
  plant.advance(0.01);
  plant.command(one(6));  // 6 (1 - exp(-t/T)) passes 3 at T log 2
  plant.advance(0.2);
  // From there m a = 6 (1 - exp(-t/T)) - 3.
  const double T = 0.05, t1 = T * std::log(2.0), t = 0.2 - t1;
  const double way = (1.5 * t * t - 3 * T * (t - T * (1 - std::exp(-t / T)))) / kMass;
  EXPECT_NEAR(plant.q()(0), way, 1e-9);
  EXPECT_NEAR(plant.counts().stuck_s, 0.01 + t1, 1e-6);
}

TEST(Plant, ReversalsUnderASwingingTorqueDoNotChatter) {
  Plant plant = carriage(0.1, 1.0);
  plant.start(one(0), one(0));
  for (int k = 0; k < 4000; ++k) {
    plant.command(one(4 * std::sin(2 * std::numbers::pi * 2 * k * 1e-3)));
    plant.advance(1e-3);
  }
  EXPECT_NEAR(static_cast<double>(plant.counts().reversals), 16, 1);  // two a period of 0.5 s
  EXPECT_LT(plant.counts().steps, 4200);
}

TEST(Plant, PreslidingIsASpringThatYields) {
  constexpr double kBristle = 0.01;
  Plant plant = carriage(0, kCoulomb, {effect_of(effect_id<effects::Presliding>, 0, {kCoulomb}, {kBristle})});
  plant.start(one(0), one(0));
  // Friction c (1 - exp(-x/D)) takes the work of a push c/2 up where x/2 = x - D (1 - exp(-x/D)): x = 1.59362426 D.
  plant.command(one(0.5 * kCoulomb));
  double furthest = 0;
  for (int k = 0; k < 4000 && plant.counts().reversals < 1; ++k) {
    plant.advance(1e-4);
    furthest = std::max(furthest, plant.q()(0));
  }
  EXPECT_NEAR(furthest / kBristle, 1.59362426, 1e-6);
  // Above the friction it slides with the rest of the push.
  plant.command(one(kCoulomb + 1));
  plant.advance(2);
  EXPECT_NEAR(plant.qdd()(0), 1 / kMass, 1e-6);
}

TEST(Plant, ADeltaAtRestIsHeldByFrictionOfItsDrives) {
  const auto robot = make_robot(delta_description("delta4"));
  Eigen::VectorXd p = delta_truth(*robot);
  for (int k = 0; k < p.size(); ++k) {
    if (robot->parameter_names()[static_cast<std::size_t>(k)].ends_with(".coulomb")) p(k) = 30;
  }
  Plant plant(robot->description(), robot->parameter_names(), p);
  const DriveVector q = DriveVector::Constant(4, 0.2), rest = DriveVector::Zero(4);
  plant.start(q, rest);
  plant.command(rest);
  plant.advance(0.5);
  EXPECT_EQ((plant.q() - q).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_EQ(plant.counts().breakaways, 0);
}

TEST(Plant, TheTelescopeSticksWhileTheDrivesMoveAcross) {
  // A bar whose guide holds with 5000 N cannot change its length: the plate moves on a sphere about the upper joint.
  const auto robot = make_robot(delta_description("delta4"));
  Eigen::VectorXd p = delta_truth(*robot);
  for (int k = 0; k < p.size(); ++k) {
    if (robot->parameter_names()[static_cast<std::size_t>(k)] == "telescope.coulomb") p(k) = 5000;
  }
  Plant plant(robot->description(), robot->parameter_names(), p);
  DriveVector q(4), rest = DriveVector::Zero(4), push(4), z(4), z0(4);
  q << 0.3, 0.2, 0.1, 0.0;
  push << 25, -20, 10, 0;
  plant.start(q, rest);
  plant.command(push);
  Eigen::VectorXd pose(4);
  ASSERT_EQ(robot->forward_kinematics(q, pose), Status::ok);
  const double length = pose.head<3>().norm();
  double moved = 0;
  const Eigen::Vector3d start = pose.head<3>();
  for (int k = 0; k < 100; ++k) {
    plant.advance(1e-3);
    ASSERT_EQ(robot->forward_kinematics(plant.q(), pose), Status::ok);
    EXPECT_NEAR(pose.head<3>().norm(), length, 1e-9);
    moved = (pose.head<3>() - start).norm();
  }
  EXPECT_GT(moved, 0.01);
}

/// A delta4 pushed about; everything there is moves.
Plant pushed(const std::vector<Effect>& effects, const PlantOptions& options, double* imbalance) {
  const auto robot = make_robot(delta_description("delta4"));
  Plant plant(robot->description(), robot->parameter_names(), delta_truth(*robot), effects, options);
  plant.start(DriveVector::Constant(4, 0.25), DriveVector::Zero(4));
  const double energy = plant.energy();
  DriveVector tau(4), pull(4);
  for (int k = 0; k < 400; ++k) {
    const double t = k * 2e-3;
    for (int j = 0; j < 4; ++j) tau(j) = (j < 3 ? -9 + 14 * std::sin(11 * t + 2 * j) : 1.6 * std::sin(17 * t));
    pull = plant.q();
    for (int j = 0; j < 3; ++j) tau(j) += 40 * (0.25 - pull(j));
    plant.command(tau);
    plant.advance(2e-3);
  }
  if (imbalance != nullptr) *imbalance = std::abs(plant.energy() - energy - plant.work() + plant.losses());
  return plant;
}

const std::vector<Effect>& many_effects() {
  static const std::vector<Effect> effects = {effect_of(effect_id<effects::Stribeck>, 0, {2}, {0.3, 2}),
                                              effect_of(effect_id<effects::LoadDependentFriction>, 1, {0.1}, {}),
                                              effect_of(effect_id<effects::TorqueRipple>, 1, {0.4, 0.1}, {15}),
                                              effect_of(effect_id<effects::AerodynamicDrag>, -1, {2}, {}),
                                              effect_of(effect_id<effects::RotorInertia>, 2, {0.02}, {}),
                                              effect_of(effect_id<effects::TelescopeSideLoad>, -1, {0.2}, {}),
                                              effect_of(effect_id<effects::ThermalDrift>, 3, {0.02}, {0.5}),
                                              effect_of(effect_id<effects::Hysteresis>, 2, {1}, {0.1, 2}),
                                              effect_of(effect_id<effects::BaseTilt>, -1, {0.03, -0.02}, {}),
                                              effect_of(effect_id<effects::Payload>, -1, {0.5}, {1}),
                                              effect_of(effect_id<effects::HoseForce>, -1, {1, 2, 3, 20, 10, 5}, {})};
  return effects;
}

TEST(Plant, EnergyIsAccountedFor) {
  double imbalance = 1;
  const Plant plain = pushed({}, {}, &imbalance);
  EXPECT_GT(plain.losses(), 1);
  EXPECT_GT(plain.counts().reversals, 10);
  EXPECT_LT(imbalance, 1e-8);
  for (const Effect& effect : many_effects()) {
    (void)pushed({effect}, {}, &imbalance);
    EXPECT_LT(imbalance, 1e-7) << effect_kind(effect.id).name;
  }
  (void)pushed({effect_of(effect_id<effects::JointElasticity>, 0, {2e-5}, {}),
                effect_of(effect_id<effects::Backlash>, 1, {0.5}, {0.01})},
               {}, &imbalance);
  EXPECT_LT(imbalance, 1e-6);
  (void)pushed({effect_of(effect_id<effects::PassiveJointFriction>, -1, {0.2}, {})}, {}, &imbalance);
  EXPECT_LT(imbalance, 1e-7);
}

TEST(Plant, ATighterToleranceComesCloserToTheTruth) {
  const auto ends = [](double tolerance) {
    PlantOptions options;
    options.tolerance = tolerance;
    return Eigen::VectorXd(pushed({}, options, nullptr).q());
  };
  const Eigen::VectorXd truth = ends(1e-13);
  double previous = 1;
  for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
    const double error = (ends(tolerance) - truth).cwiseAbs().maxCoeff();
    EXPECT_LT(error, 100 * tolerance);
    EXPECT_LE(error, previous + 1e-12);
    previous = error;
  }
}

TEST(Plant, MovesByTheTorqueThatItsOwnMotionTakes) {
  // Forward and backward are different code: one solves for accelerations with rest and events, the other only adds up.
  const auto robot = make_robot(delta_description("delta4"));
  std::vector<Effect> effects = many_effects();
  effects.erase(std::remove_if(effects.begin(), effects.end(),
                               // Its state is integrated otherwise
                               [](const Effect& e) { return e.id == effect_id<effects::Hysteresis>; }),
                effects.end());
  effects.push_back(effect_of(effect_id<effects::DirectionalEfficiency>, 0, {0.1, 0.05}, {}));
  effects.push_back(effect_of(effect_id<effects::PassiveJointFriction>, -1, {0.05}, {}));
  effects.push_back(effect_of(effect_id<effects::KinematicOffset>, 1, {0.01}, {0}));
  Plant plant(robot->description(), robot->parameter_names(), delta_truth(*robot), effects);
  plant.start(DriveVector::Constant(4, 0.25), DriveVector::Zero(4));
  DriveVector tau(4);
  int compared = 0;
  for (int k = 0; k < 400; ++k) {
    const double t = k * 2e-3;
    for (int j = 0; j < 4; ++j)
      tau(j) = (j < 3 ? -9 + 12 * std::sin(11 * t + 2 * j) + 40 * (0.25 - plant.q()(j)) : 1.6 * std::sin(17 * t));
    const long loosened = plant.counts().breakaways;
    plant.command(tau);
    const std::vector<int> directions = plant.directions();
    // A joint that breaks loose at this instant has a direction already, but no rate yet.
    if (plant.counts().breakaways == loosened &&
        std::find(directions.begin(), directions.end(), 0) == directions.end()) {
      const DriveVector back = plant.inverse(plant.time(), plant.q(), plant.qd(), plant.qdd());
      EXPECT_LT((back - tau).cwiseAbs().maxCoeff(), 1e-9) << "at " << t;
      ++compared;
    }
    plant.advance(2e-3);
  }
  EXPECT_GT(compared, 200);
}

TEST(Plant, InverseIsTheModelWithoutEffects) {
  const auto robot = make_robot(delta_description("delta4"));
  const Eigen::VectorXd p = delta_truth(*robot);
  Plant plant(robot->description(), robot->parameter_names(), p);
  testing_support::SyntheticOptions options;
  options.duration_s = 0.2;
  const Log log = testing_support::synthetic_log(*robot, p, options);
  for (Eigen::Index k = 0; k < log.samples(); ++k) {
    const DriveVector tau =
        plant.inverse(log.t_s(k), log.q.row(k).transpose(), log.qd.row(k).transpose(), log.qdd.row(k).transpose());
    EXPECT_LT((tau - log.tau.row(k).transpose()).cwiseAbs().maxCoeff(), 1e-11);
  }
}

TEST(Plant, RefusesWhatCannotBe) {
  const auto robot = make_robot(delta_description("delta4"));
  const Eigen::VectorXd p = delta_truth(*robot);
  const auto make = [&](const Effect& effect) {
    return Plant(robot->description(), robot->parameter_names(), p, {effect});
  };
  EXPECT_THROW((void)make(effect_of(effect_id<effects::ShearThinning>, 0, {100}, {1, 0})), Error);
  EXPECT_THROW((void)make(effect_of(effect_id<effects::Backlash>, 0, {1.5}, {0.01})), Error);
  Plant heavy(robot->description(), robot->parameter_names(), -p);
  EXPECT_THROW(heavy.start(DriveVector::Constant(4, 0.2), DriveVector::Zero(4)), Error);
  testing_support::Lengths short_struts;
  short_struts.strut = 0.5;
  Plant apart(delta_description("delta4", short_struts), robot->parameter_names(), p);
  EXPECT_THROW(apart.start(DriveVector::Zero(4), DriveVector::Zero(4)), Error);
}

}  // namespace
}  // namespace deltadyn
