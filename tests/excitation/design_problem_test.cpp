#include "../../src/excitation/design_problem.hpp"

#include <cmath>
#include <gmock/gmock.h>

#include "../../src/excitation/search.hpp"
#include "excitation/excitation_setup.hpp"
#include "support/random_robot.hpp"

namespace deltadyn::detail {
namespace {

using testing_support::excitation_setup;
using testing_support::ExcitationSetup;
using testing_support::Random;

/// Small random amplitudes about the centre.
Eigen::VectorXd random_variables(const DesignProblem& problem, const DesignSpace& space, std::uint64_t seed) {
  Random random(seed);
  Eigen::VectorXd v(problem.variables());
  for (Eigen::Index k = 0; k < v.size(); ++k) v(k) = 0.15 * random.uniform(-1, 1);
  v(v.size() - 1) = random.uniform(0.3, 0.8);
  FourierSeries series = problem.series(v);
  series.coefficients.row(0) = space.states.centre.transpose();
  return problem.variables_of(series);
}

struct Case {
  std::string type;
  Criterion criterion;
  double velocity_weight;
  bool torque, other;
};

class Gradient : public ::testing::TestWithParam<Case> {};

// Richardson extrapolation of central differences: error of order h^6, rounding near 1e-11 of the value.
TEST_P(Gradient, OfValueAndConstraintsIsTheSlope) {
  const Case& c = GetParam();
  ExcitationSetup setup = excitation_setup(c.type, 300);
  MotionLimits limits = *setup.limits;
  if (c.torque) {
    limits.parameters = Eigen::VectorXd::Constant(setup.robot->parameters(), 0.1);
    limits.tau = Eigen::VectorXd::Constant(setup.robot->drives(), 50);
  }
  ProblemSettings settings;
  settings.criterion = c.criterion;
  settings.velocity_weight = c.velocity_weight;
  settings.harmonics = 4;
  settings.samples = 60;
  settings.sign_share = 0.1;  // wide enough for differences
  settings.sharpness = 20;
  if (c.other) {
    settings.share = 0.4;
    settings.other_information =
        0.6 * Eigen::MatrixXd::Identity(setup.space.base_parameters(), setup.space.base_parameters());
  }
  const DesignProblem problem(setup.space, limits, settings);
  const Eigen::VectorXd v = random_variables(problem, setup.space, 3);
  DesignProblem::Evaluation e, shifted;
  problem.evaluate(v, true, e);
  ASSERT_TRUE(e.regular);
  for (Eigen::Index k = 0; k < v.size(); k += 3) {
    double value[3];
    Eigen::VectorXd constraints[3];
    const double steps[] = {4e-3, 2e-3, 1e-3};
    for (int level = 0; level < 3; ++level) {
      const double h = steps[level];
      Eigen::VectorXd up = v, down = v;
      up(k) += h;
      down(k) -= h;
      problem.evaluate(up, false, shifted);
      value[level] = shifted.value / (2 * h);
      constraints[level] = shifted.constraints / (2 * h);
      problem.evaluate(down, false, shifted);
      value[level] -= shifted.value / (2 * h);
      constraints[level] -= shifted.constraints / (2 * h);
    }
    const auto extrapolated = [](const auto& coarse, const auto& middle, const auto& fine) {
      const auto a = ((4 * middle - coarse) / 3).eval(), b = ((4 * fine - middle) / 3).eval();
      return ((16 * b - a) / 15).eval();
    };
    const Eigen::Matrix<double, 1, 1> v0(value[0]), v1(value[1]), v2(value[2]);
    EXPECT_NEAR(e.gradient(k), extrapolated(v0, v1, v2)(0), 2e-6 * (1 + e.gradient.cwiseAbs().maxCoeff()))
        << "variable " << k;
    const Eigen::VectorXd slope = extrapolated(constraints[0], constraints[1], constraints[2]);
    EXPECT_LT((slope - e.jacobian.row(k).transpose()).cwiseAbs().maxCoeff(),
              2e-6 * (1 + e.jacobian.cwiseAbs().maxCoeff()))
        << "variable " << k;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Gradient,
                         ::testing::Values(Case{"delta4", Criterion::log_det, 0, false, false},
                                           Case{"delta4", Criterion::trace, 2, true, true},
                                           Case{"delta3", Criterion::det, 1, true, false},
                                           Case{"delta3", Criterion::cond, 0, false, false},
                                           Case{"linear-delta3", Criterion::min_eigenvalue, 0, false, true},
                                           Case{"axis", Criterion::log_det, 1, true, false}),
                         [](const auto& param_info) { return "case" + std::to_string(param_info.index); });

TEST(DesignProblem, InformationIsThatOfTheRobotsRegressor) {
  const ExcitationSetup setup = excitation_setup("delta3", 300);
  ProblemSettings settings;
  settings.sign_share = 0;
  settings.samples = 40;
  const DesignProblem problem(setup.space, *setup.limits, settings);
  const Eigen::VectorXd v = random_variables(problem, setup.space, 5);
  DesignProblem::Evaluation e;
  problem.evaluate(v, false, e);
  ASSERT_TRUE(e.regular);
  const FourierSeries series = problem.series(v);
  const int p = setup.space.base_parameters();
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(p, p), Y(3, setup.robot->parameters());
  Eigen::VectorXd q(3), qd(3), qdd(3);
  for (int i = 0; i < settings.samples; ++i) {
    const double phase = 2 * 3.14159265358979323846 * i / settings.samples;
    ASSERT_EQ(setup.robot->to_drives(series.state(phase, series.omega(), 0), q, qd, qdd), Status::ok);
    ASSERT_EQ(setup.robot->regressor(q, qd, qdd, Y), Status::ok);
    for (int a = 0; a < p; ++a) {
      for (int b = 0; b < p; ++b) {
        for (int drive = 0; drive < 3; ++drive) {
          const double scale = setup.space.torque_scale(drive) * setup.space.torque_scale(drive);
          M(a, b) += Y(drive, setup.space.base_columns[static_cast<std::size_t>(a)]) *
                     Y(drive, setup.space.base_columns[static_cast<std::size_t>(b)]) / scale /
                     (setup.space.column_scale(a) * setup.space.column_scale(b) * settings.samples);
        }
      }
    }
  }
  EXPECT_LT((M - e.information).cwiseAbs().maxCoeff(), 1e-9 * M.cwiseAbs().maxCoeff());
}

TEST(DesignProblem, SmoothLimitsLieInsideTheTrueOnesByLittle) {
  const ExcitationSetup setup = excitation_setup("delta4", 300);
  ProblemSettings settings;
  const DesignProblem problem(setup.space, *setup.limits, settings);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    DesignProblem::Evaluation e;
    problem.evaluate(random_variables(problem, setup.space, seed), false, e);
    ASSERT_TRUE(e.regular);
    EXPECT_GE(e.constraints.maxCoeff(), e.worst - 1);
    EXPECT_LE(e.constraints.maxCoeff(),
              e.worst - 1 + std::log(2.0 * settings.samples / settings.windows) / settings.sharpness);
  }
}

// There is no slope to follow; the search must end, and not ask for ever.
TEST(LocalSearch, EndsWhereTheStartCannotBeEvaluated) {
  const ExcitationSetup setup = excitation_setup("delta3", 300);
  const DesignProblem problem(setup.space, *setup.limits, {});
  Eigen::VectorXd start = Eigen::VectorXd::Constant(problem.variables(), 100);
  int asked = 0;
  const SearchResult found = local_search(problem, start, 50, [&asked] { return ++asked > 10000; });
  EXPECT_LT(asked, 10000);
  start(start.size() - 1) = 1;
  EXPECT_EQ(found.best.head(start.size() - 1), start.head(start.size() - 1));
}

TEST(DesignProblem, SaysWhereItCannotBeEvaluated) {
  const ExcitationSetup setup = excitation_setup("delta3", 300);
  const DesignProblem problem(setup.space, *setup.limits, {});
  DesignProblem::Evaluation e;
  problem.evaluate(Eigen::VectorXd::Constant(problem.variables(), 100), true, e);
  EXPECT_FALSE(e.regular);
  problem.evaluate(Eigen::VectorXd::Constant(problem.variables(), std::nan("")), true, e);
  EXPECT_FALSE(e.regular);
}

}  // namespace
}  // namespace deltadyn::detail
