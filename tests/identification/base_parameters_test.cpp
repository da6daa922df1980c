#include "deltadyn/identification/base_parameters.hpp"

#include <algorithm>
#include <gtest/gtest.h>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/workspace.hpp"

#include "support/descriptions.hpp"
#include "support/matchers.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

struct Count {
  const char* label;
  RobotDescription robot;
  ParameterOptions options;
  int columns, base;
};

void PrintTo(const Count& count, std::ostream* stream) {
  *stream << count.label;
}

ParameterOptions options(bool individual_limbs, bool tool) {
  ParameterOptions o;
  o.individual_limbs = individual_limbs;
  o.tool = tool;
  return o;
}

class BaseParametersOf : public ::testing::TestWithParam<Count> {};

INSTANTIATE_TEST_SUITE_P(
    Robots, BaseParametersOf,
    ::testing::Values(Count{"delta4", delta_description("delta4"), options(false, true), 70, 37},
                      Count{"delta4_without_tool", delta_description("delta4"), options(false, false), 60, 34},
                      Count{"delta4_individual_limbs", delta_description("delta4"), options(true, true), 110, 59},
                      Count{"delta3", delta_description("delta3"), options(false, true), 36, 18},
                      // mcx, mcz, Iyy and friction of a pendulum; mass and friction of a carriage
                      Count{"axis", axis_description(DriveKind::revolute), options(false, true), 12, 5},
                      Count{"linear_axis", axis_description(DriveKind::prismatic), options(false, true), 12, 3}),
    [](const auto& which) { return std::string(which.param.label); });

TEST_P(BaseParametersOf, AreAsManyAsThePaperSays) {
  const auto robot = make_robot(GetParam().robot, GetParam().options);
  const BaseParameters base = find_base_parameters(*robot);
  EXPECT_EQ(robot->parameters(), GetParam().columns);
  EXPECT_EQ(base.count(), GetParam().base);
  EXPECT_GT(base.rank_gap, 1e5);
}

TEST_P(BaseParametersOf, GiveTheTorqueOfAllParametersOnFreshStates) {
  const auto robot = make_robot(GetParam().robot, GetParam().options);
  const BaseParameters base = find_base_parameters(*robot);
  Random random(21);
  Eigen::VectorXd p(robot->parameters());
  for (Eigen::Index k = 0; k < p.size(); ++k) p(k) = random.uniform(-1, 1);
  const Eigen::VectorXd beta = base.B * p;
  WorkspaceSampler sampler(*robot, 987654321);
  Eigen::VectorXd q, qd, qdd;
  Eigen::MatrixXd Y(robot->drives(), robot->parameters());
  for (int state = 0; state < 200; ++state) {
    sampler.next(q, qd, qdd);
    ASSERT_EQ(robot->regressor(q, qd, qdd, Y), Status::ok);
    Eigen::VectorXd reduced = Eigen::VectorXd::Zero(robot->drives());
    for (int i = 0; i < base.count(); ++i) reduced += Y.col(base.independent[static_cast<std::size_t>(i)]) * beta(i);
    EXPECT_THAT(reduced, IsNear((Y * p).eval(), 1e-8 * (Y.cwiseAbs() * p.cwiseAbs()).maxCoeff())) << "state " << state;
  }
}

TEST_P(BaseParametersOf, KeepTheIndependentColumnsAsTheyAre) {
  const auto robot = make_robot(GetParam().robot, GetParam().options);
  const BaseParameters base = find_base_parameters(*robot);
  EXPECT_TRUE(std::is_sorted(base.independent.begin(), base.independent.end()));
  for (int i = 0; i < base.count(); ++i) {
    const auto column = static_cast<std::size_t>(base.independent[static_cast<std::size_t>(i)]);
    EXPECT_EQ(base.B.col(static_cast<Eigen::Index>(column)), Eigen::VectorXd::Unit(base.count(), i));
    EXPECT_EQ(base.expressions[static_cast<std::size_t>(i)].rfind(robot->parameter_names()[column], 0), 0U)
        << base.expressions[static_cast<std::size_t>(i)];
    EXPECT_EQ(base.units[static_cast<std::size_t>(i)], robot->parameter_units()[column]);
  }
}

TEST(BaseParameters, DoNotDependOnTheSeed) {
  const auto robot = make_robot(delta_description("delta4"));
  BaseParameterOptions other;
  other.seed = 77;
  const BaseParameters one = find_base_parameters(*robot);
  const BaseParameters two = find_base_parameters(*robot, other);
  EXPECT_EQ(one.count(), two.count());
  // The row spaces are the same, whichever columns were chosen: B2 picked on one's columns turns B1 into B2.
  Eigen::MatrixXd change(two.count(), one.count());
  for (int i = 0; i < one.count(); ++i) change.col(i) = two.B.col(one.independent[static_cast<std::size_t>(i)]);
  EXPECT_THAT((change * one.B).eval(), IsNear(two.B, 1e-6));
}

TEST(BaseParameters, RefuseOptionsOutOfRange) {
  const auto robot = make_robot(delta_description("delta3"));
  BaseParameterOptions few;
  few.states = 5;
  EXPECT_THROW((void)find_base_parameters(*robot, few), Error);
  BaseParameterOptions coarse;
  coarse.tolerance = 2;
  EXPECT_THROW((void)find_base_parameters(*robot, coarse), Error);
}

}  // namespace
}  // namespace deltadyn
