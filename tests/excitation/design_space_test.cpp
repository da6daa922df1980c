#include "deltadyn/excitation/design_space.hpp"

#include <gmock/gmock.h>

#include "deltadyn/runtime/error.hpp"

#include "excitation/excitation_setup.hpp"

namespace deltadyn {
namespace {

using ::testing::HasSubstr;
using testing_support::excitation_setup;
using testing_support::ExcitationSetup;
using testing_support::usual_limits;

std::string message_of(const Robot& robot, const MotionLimits& limits) {
  try {
    (void)admissible_states(robot, *make_task_regressor(robot), limits, 200, 1);
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

class AdmissibleStatesOf : public ::testing::TestWithParam<const char*> {};

TEST_P(AdmissibleStatesOf, KeepEveryLimitAndFillTheBoxes) {
  const ExcitationSetup setup = excitation_setup(GetParam(), 1500);
  const AdmissibleStates& states = setup.space.states;
  ASSERT_EQ(states.x.cols(), 1500);
  const int n = setup.robot->drives();
  LimitedState state;
  state.drives.resize(3 * n);
  Eigen::VectorXd q(n), qd(n), qdd(n);
  double largest = 0;
  for (Eigen::Index k = 0; k < states.x.cols(); ++k) {
    state.x = states.x.col(k);
    ASSERT_EQ(setup.robot->to_drives({state.x.head(n), state.x.segment(n, n), state.x.tail(n)}, q, qd, qdd),
              Status::ok);
    state.drives << q, qd, qdd;
    for (const Limit& limit : setup.limits->list(setup.robot->description())) {
      const double load = limit_load(limit, usage_of(limit, limited_value(limit, *setup.limits, state)));
      ASSERT_LE(load, 1 + 1e-9) << limit.name;
      largest = std::max(largest, load);
    }
  }
  EXPECT_GT(largest, 0.97);
  EXPECT_NEAR(states.x.row(n).mean(), 0, 0.1 * setup.space.rate_scale(0)) << "rates to either side";
}

INSTANTIATE_TEST_SUITE_P(Robots, AdmissibleStatesOf, ::testing::Values("delta3", "linear-delta3", "delta4", "axis"),
                         [](const auto& param_info) {
                           std::string name = param_info.param;
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return name;
                         });

TEST(DesignSpace, SameSeedSameStates) {
  const ExcitationSetup a = excitation_setup("delta4", 300), b = excitation_setup("delta4", 300);
  EXPECT_EQ(a.space.states.x, b.space.states.x);
}

TEST(DesignSpace, ColumnsHaveRootMeanSquareOne) {
  const ExcitationSetup setup = excitation_setup("delta3", 500);
  Eigen::MatrixXd A(3, setup.space.base_parameters());
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(setup.space.base_parameters());
  for (Eigen::Index k = 0; k < setup.space.states.x.cols(); ++k) {
    ASSERT_EQ(setup.space.weighted_columns(setup.space.states.x.col(k), A), Status::ok);
    squares += A.colwise().squaredNorm().transpose();
  }
  EXPECT_LT((squares.array() / 500 - 1).abs().maxCoeff(), 1e-9);
}

// With a torque limit that few states at full speed keep, slower ones are found, and the centre holds itself and its
// friction.
TEST(DesignSpace, FindsSlowStatesWhereTorqueIsShort) {
  const auto robot = make_robot(testing_support::delta_description("delta3"));
  MotionLimits limits = usual_limits(*robot);
  limits.parameters = Eigen::VectorXd::Zero(robot->parameters());
  for (std::size_t k = 0; k < robot->parameter_names().size(); ++k) {
    const std::string& name = robot->parameter_names()[k];
    if (name == "platform.m") limits.parameters(static_cast<Eigen::Index>(k)) = 2;
    if (name.ends_with(".coulomb")) limits.parameters(static_cast<Eigen::Index>(k)) = 1;
  }
  const auto regressor = make_task_regressor(*robot);
  const auto torque_at = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    Eigen::MatrixXd Y(3, robot->parameters());
    Eigen::VectorXd drives(9);
    EXPECT_EQ(regressor->evaluate(x, Eigen::VectorXd(), Y, drives), Status::ok);
    return Y * limits.parameters;
  };
  Eigen::VectorXd middle = Eigen::VectorXd::Zero(9);
  middle.head<3>() = limits.region->centre;
  limits.tau.setConstant(1.1 * (torque_at(middle).cwiseAbs().maxCoeff() + 1));
  const AdmissibleStates states = admissible_states(*robot, *regressor, limits, 800, 1);
  EXPECT_EQ(states.x.cols(), 800);
  EXPECT_GT(states.drawn, 20000) << "few states at full speed keep the limit";
  for (Eigen::Index k = 0; k < states.x.cols(); ++k)
    ASSERT_LE(torque_at(states.x.col(k)).cwiseAbs().maxCoeff(), limits.tau(0) * (1 + 1e-9));
  for (const double direction : {-1e-6, 1e-6}) {
    Eigen::VectorXd slight = Eigen::VectorXd::Zero(9);
    slight.head<3>() = states.centre;
    slight(5) = direction;
    EXPECT_LE(torque_at(slight).cwiseAbs().maxCoeff(), limits.tau(0));
  }
}

TEST(DesignSpace, SaysSoWhereTheRangesMeetTheWorkspaceNowhere) {
  const auto robot = make_robot(testing_support::delta_description("delta3"));
  MotionLimits limits = usual_limits(*robot);
  limits.region->shape = RegionShape::ball;
  limits.region->radius = 0.1;
  // Of the box around the ball, which it does not fill
  const Eigen::Vector3d corner = limits.region->centre.array() + 0.09;
  limits.z_lower.head<3>() = corner;
  EXPECT_THAT(message_of(*robot, limits), HasSubstr("none lies in the workspace"));
}

TEST(DesignSpace, NamesTheLimitThatLeavesNothing) {
  const auto robot = make_robot(testing_support::delta_description("delta4"));
  MotionLimits far = usual_limits(*robot);
  far.region->centre.z() = -3;
  EXPECT_THAT(message_of(*robot, far), HasSubstr("reaches only 0.0 % of the workspace"));
  MotionLimits stretched = usual_limits(*robot);
  stretched.q_lower(1) = 1.4;  // the workspace needs drive 2 elsewhere
  EXPECT_THAT(message_of(*robot, stretched), HasSubstr("'drive 2 position' (1.4 to 1.6 rad)"));
  MotionLimits none = usual_limits(*robot);
  none.zd.setConstant(std::numeric_limits<double>::infinity());
  none.qd(2) = std::numeric_limits<double>::infinity();
  EXPECT_THAT(message_of(*robot, none), HasSubstr("neither z nor drive 3 has a limit of its velocity"));
}

}  // namespace
}  // namespace deltadyn
