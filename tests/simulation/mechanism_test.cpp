#include "deltadyn/simulation/mechanism.hpp"

#include <gtest/gtest.h>
#include <memory>

#include "deltadyn/runtime/effect_states.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/runtime/workspace.hpp"

#include "identification/synthetic_log.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using testing_support::delta_description;
using testing_support::delta_truth;

/// A robot with every limb on its own, its true parameters, and the mechanism made of both.
struct Pair {
  explicit Pair(const std::string& type, const MechanismOptions& options = {}) {
    ParameterOptions all;
    all.individual_limbs = all.offset = true;
    for (int j = 1; j <= delta_description(type).drives(); ++j) all.rotor_inertia.push_back(j);
    robot = make_robot(delta_description(type), all);
    p = delta_truth(*robot);
    for (int k = 0; k < robot->parameters(); ++k) {
      const std::string& name = robot->parameter_names()[static_cast<std::size_t>(k)];
      if (name.find("rotor") != std::string::npos) p(k) = 0.01;
      if (name.find("offset") != std::string::npos || name.find("viscous") != std::string::npos ||
          name.find("coulomb") != std::string::npos) {
        p(k) = 0;
      }
    }
    mechanism = make_mechanism(robot->description(), p, options);
  }
  std::unique_ptr<Robot> robot;
  Eigen::VectorXd p;
  std::unique_ptr<Mechanism> mechanism;
};

class EveryType : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryType, HasTheEquationsOfMotionOfTheModel) {
  const Pair pair(GetParam());
  WorkspaceSampler sampler(*pair.robot, 3);
  const int n = pair.robot->drives();
  Eigen::VectorXd q(n), qd(n), qdd(n), tau(n);
  MechanismTerms terms;
  for (int k = 0; k < 50; ++k) {
    sampler.next(q, qd, qdd);
    ASSERT_EQ(pair.mechanism->evaluate(q, qd, terms), Status::ok);
    ASSERT_EQ(pair.robot->inverse_dynamics(q, qd, qdd, pair.p, tau), Status::ok);
    const Eigen::VectorXd sum = terms.M * qdd + terms.bias;
    EXPECT_LT((sum - tau).cwiseAbs().maxCoeff(), 1e-10 * (1 + tau.cwiseAbs().maxCoeff()));
  }
}

TEST_P(EveryType, JointRatesAndTheirAccelerationsAreDerivatives) {
  MechanismOptions options;
  options.passive_joints = true;
  const Pair pair(GetParam(), options);
  WorkspaceSampler sampler(*pair.robot, 4);
  const int n = pair.robot->drives();
  Eigen::VectorXd q(n), qd(n), qdd(n);
  MechanismTerms now, before, after;
  constexpr double h = 1e-5;
  for (int k = 0; k < 20; ++k) {
    sampler.next(q, qd, qdd);
    ASSERT_EQ(pair.mechanism->evaluate(q, qd, now), Status::ok);
    // Along a motion without drive acceleration.
    ASSERT_EQ(pair.mechanism->evaluate(q - h * qd, qd, before), Status::ok);
    ASSERT_EQ(pair.mechanism->evaluate(q + h * qd, qd, after), Status::ok);
    const Eigen::VectorXd rate = now.J * qd;
    EXPECT_LT((rate - now.rate).cwiseAbs().maxCoeff(), 1e-10 * (1 + rate.cwiseAbs().maxCoeff()));
    const Eigen::VectorXd bias = (after.rate - before.rate) / (2 * h);
    EXPECT_LT((bias - now.bias_rate).cwiseAbs().maxCoeff(), 1e-5 * (1 + bias.cwiseAbs().maxCoeff()));
    if (pair.mechanism->inner_joint() >= 0) {
      const int bar = pair.mechanism->inner_joint();
      EXPECT_NEAR((after.position(bar) - before.position(bar)) / (2 * h), now.rate(bar), 1e-6);
    }
    const Eigen::Vector3d v = (after.r - before.r) / (2 * h), a = (after.v - before.v) / (2 * h);
    EXPECT_LT((v - now.v).norm(), 1e-6 * (1 + v.norm()));
    EXPECT_LT((a - now.a_bias).norm(), 1e-5 * (1 + a.norm()));
  }
}

TEST_P(EveryType, PassiveJointsAreThoseOfTheEffect) {
  MechanismOptions options;
  options.passive_joints = true;
  const Pair pair(GetParam(), options);
  const auto states = make_effect_states(pair.robot->description());
  WorkspaceSampler sampler(*pair.robot, 5);
  const int n = pair.robot->drives(), first = pair.robot->friction_joints();
  Eigen::VectorXd q(n), qd(n), qdd(n);
  MechanismTerms terms;
  EffectState state;
  for (int k = 0; k < 20; ++k) {
    sampler.next(q, qd, qdd);
    ASSERT_EQ(pair.mechanism->evaluate(q, qd, terms), Status::ok);
    ASSERT_EQ(states->at(q, qd, qdd, state), Status::ok);
    ASSERT_EQ(state.passive_rate.size(), pair.mechanism->joints() - first);
    for (int j = first; j < pair.mechanism->joints(); ++j) {
      EXPECT_NEAR(state.passive_rate(j - first), terms.rate(j), 1e-10);
      const Eigen::RowVectorXd J = pair.mechanism->multiplicity(j) * terms.J.row(j);
      EXPECT_LT((state.J_passive.row(j - first) - J).cwiseAbs().maxCoeff(), 1e-10);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, EveryType, ::testing::Values("delta3", "linear-delta3", "delta4"));

TEST(Mechanism, HomeOffsetMovesTheTruePose) {
  MechanismOptions options;
  options.home_offset = DriveVector::Constant(3, 0.02);
  const Pair moved("delta3", options), plain("delta3");
  MechanismTerms a, b;
  const DriveVector q = DriveVector::Constant(3, 0.3), rest = DriveVector::Zero(3);
  ASSERT_EQ(moved.mechanism->evaluate(q, rest, a), Status::ok);
  ASSERT_EQ(plain.mechanism->evaluate(q.array() + 0.02, rest, b), Status::ok);
  EXPECT_LT((a.r - b.r).norm(), 1e-14);
}

TEST(Mechanism, RefusesAWrongCountOfParameters) {
  EXPECT_THROW((void)make_mechanism(delta_description("delta3"), Eigen::VectorXd::Zero(5)), Error);
}

}  // namespace
}  // namespace deltadyn
