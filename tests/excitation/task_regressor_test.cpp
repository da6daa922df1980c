#include "deltadyn/excitation/task_regressor.hpp"

#include <cmath>
#include <gmock/gmock.h>
#include <unsupported/Eigen/AutoDiff>

#include "deltadyn/dynamics/regressor.hpp"
#include "deltadyn/runtime/geometry_of.hpp"
#include "deltadyn/runtime/workspace.hpp"

#include "support/descriptions.hpp"
#include "support/matchers.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using testing_support::delta_description;
using testing_support::four_limb_description;
using testing_support::IsNear;
using testing_support::Random;
using testing_support::random_task;

template <class R>
RobotDescription description_of() {
  return kHasPlate<R> ? delta_description(R::kName) : testing_support::axis_description(R::kDrive);
}

template <class R>
class TaskRegressorTest : public ::testing::Test {
 public:
  static constexpr int N = R::kDrives;
  using State = Vector<double, 3 * N>;
  using Layout = ParameterLayout<R, Limbs::shared>;
  /// Eigen's numbers with derivatives, through every line of the core: no code in common with the product's way.
  using Number = Eigen::AutoDiffScalar<State>;

  TaskRegressorTest() : robot(make_robot(description_of<R>(), options())), regressor(make_task_regressor(*robot)) {}

  /// Every column of the layout.
  static ParameterOptions options() {
    ParameterOptions all;
    for (int i = 1; i <= N; ++i) all.rotor_inertia.push_back(i);
    all.offset = true;
    return all;
  }
  Eigen::VectorXd random_state() {
    const auto task = random_task<R>(random);
    Eigen::VectorXd x(3 * N);
    x << task.z, task.zd, task.zdd;
    return x;
  }
  void automatic(const Eigen::VectorXd& x, const Eigen::MatrixXd& G, double width, Eigen::VectorXd& gradient,
                 Eigen::MatrixXd& jacobian) const {
    const auto geometry = geometry_of<Number, R>(robot->description());
    Vector<Number, N> z, zd, zdd;
    for (int i = 0; i < N; ++i) {
      z(i) = Number(x(i), 3 * N, i);
      zd(i) = Number(x(N + i), 3 * N, N + i);
      zdd(i) = Number(x(2 * N + i), 3 * N, 2 * N + i);
    }
    Motion<Number, R> motion;
    ASSERT_EQ(motion_from_task(geometry, z, zd, zdd, motion), Status::ok);
    Matrix<Number, N, Layout::kColumns> Y;
    deltadyn::regressor<Layout>(geometry, motion, Y);
    if (width > 0) {
      for (int joint = 0; joint < Layout::kFrictionJoints; ++joint) {
        const auto f = friction_joint(motion, joint);
        const Number size = sqrt(f.rate * f.rate + Number(width * width));
        for (int i = 0; i < N; ++i) Y(i, Layout::coulomb(joint)) = f.rate / size * f.J(i);
      }
    }
    gradient = Eigen::VectorXd::Zero(3 * N);
    for (int i = 0; i < N; ++i)
      for (int k = 0; k < Layout::kColumns; ++k) gradient += G(i, k) * Y(i, k).derivatives();
    jacobian.resize(3 * N, 3 * N);
    for (int i = 0; i < N; ++i) {
      jacobian.row(i) = motion.posture.q(i).derivatives().transpose();
      jacobian.row(N + i) = motion.qd(i).derivatives().transpose();
      jacobian.row(2 * N + i) = motion.qdd(i).derivatives().transpose();
    }
  }

  Random random{7};
  std::unique_ptr<Robot> robot;
  std::unique_ptr<TaskRegressor> regressor;
};

using Robots = ::testing::Types<Delta3, LinearDelta3, Delta4, Axis, LinearAxis>;
TYPED_TEST_SUITE(TaskRegressorTest, Robots);

TYPED_TEST(TaskRegressorTest, ColumnsAreThoseOfTheRobot) {
  ASSERT_EQ(this->regressor->parameters(), this->robot->parameters());
  Eigen::MatrixXd Y(TestFixture::N, this->robot->parameters()), expected = Y;
  Eigen::VectorXd drives(3 * TestFixture::N);
  for (int k = 0; k < 20; ++k) {
    const Eigen::VectorXd x = this->random_state();
    ASSERT_EQ(this->regressor->evaluate(x, Eigen::VectorXd(), Y, drives), Status::ok);
    ASSERT_EQ(this->robot->regressor(drives.head(TestFixture::N), drives.segment(TestFixture::N, TestFixture::N),
                                     drives.tail(TestFixture::N), expected),
              Status::ok);
    EXPECT_THAT(Y, IsNear(expected, 1e-9 * expected.cwiseAbs().maxCoeff()));
  }
}

TYPED_TEST(TaskRegressorTest, DerivativesAreThoseOfAutomaticDifferentiation) {
  constexpr int n = TestFixture::N;
  Eigen::VectorXd expected;
  Eigen::MatrixXd gradients(3 * n, 2), jacobian(3 * n, 3 * n), expected_jacobian;
  for (int k = 0; k < 20; ++k) {
    const double width = k % 2 == 0 ? 0.3 : 0.0;
    const Eigen::VectorXd x = this->random_state(),
                          widths = Eigen::VectorXd::Constant(this->regressor->friction_joints(), width);
    Eigen::MatrixXd G(2 * n, this->robot->parameters());
    for (Eigen::Index i = 0; i < G.size(); ++i) G(i) = this->random.uniform(-1, 1);
    ASSERT_EQ(this->regressor->differentiate(x, widths, G, gradients, jacobian), Status::ok);
    for (int sum = 0; sum < 2; ++sum) {
      this->automatic(x, G.middleRows(sum * n, n), width, expected, expected_jacobian);
      EXPECT_THAT(gradients.col(sum).eval(), IsNear(expected, 1e-9 * (1 + expected.cwiseAbs().maxCoeff())));
      EXPECT_THAT(jacobian, IsNear(expected_jacobian, 1e-9 * (1 + expected_jacobian.cwiseAbs().maxCoeff())));
    }
  }
}

TYPED_TEST(TaskRegressorTest, SaysWhenThePoseIsOutOfReach) {
  if constexpr (kHasPlate<TypeParam>) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(3 * TestFixture::N), drives(3 * TestFixture::N),
                    gradient(3 * TestFixture::N);
    x(0) = 5;
    Eigen::MatrixXd Y(TestFixture::N, this->robot->parameters()), jacobian(3 * TestFixture::N, 3 * TestFixture::N);
    EXPECT_EQ(this->regressor->evaluate(x, Eigen::VectorXd(), Y, drives), Status::unreachable);
    Y.setZero();
    EXPECT_EQ(this->regressor->differentiate(x, Eigen::VectorXd(), Y, gradient, jacobian), Status::unreachable);
  }
}

// Plates that turn, with limbs that share their parameters and with limbs of their own, against differences.
TEST(TaskRegressorOfAPlate, DerivativesAreThoseOfDifferences) {
  for (const char* type : {"h4", "i4", "par4"}) {
    for (const bool individual : {false, true}) {
      const auto robot = make_robot(four_limb_description(type), {individual, true, {2}, true});
      const auto regressor = make_task_regressor(*robot);
      WorkspaceSampler sampler(*robot, 9);
      Eigen::VectorXd q, qd, qdd, x(12), out(12);
      sampler.next(q, qd, qdd);
      TaskState task;
      ASSERT_EQ(robot->to_task(q, qd, qdd, task), Status::ok);
      x << task.z, task.zd, task.zdd;
      const Eigen::VectorXd widths = Eigen::VectorXd::Constant(regressor->friction_joints(), 0.5);
      const Eigen::MatrixXd G = Eigen::MatrixXd::Random(4, robot->parameters());
      Eigen::MatrixXd gradients(12, 1), jacobian(12, 12), Y(4, robot->parameters());
      ASSERT_EQ(regressor->differentiate(x, widths, G, gradients, jacobian), Status::ok);
      const auto sum_at = [&](const Eigen::VectorXd& at) {
        EXPECT_EQ(regressor->evaluate(at, widths, Y, out), Status::ok);
        return G.cwiseProduct(Y).sum();
      };
      for (int k = 0; k < 12; ++k) {
        const double step = 1e-6 * (1 + std::abs(x(k)));
        const Eigen::VectorXd by = step * Eigen::VectorXd::Unit(12, k);
        const double slope = (sum_at(x + by) - sum_at(x - by)) / (2 * step);
        EXPECT_NEAR(gradients(k, 0), slope, 1e-5 * (gradients.cwiseAbs().maxCoeff() + 1))
            << type << (individual ? ", individual, " : ", shared, ") << k;
      }
    }
  }
}

}  // namespace
}  // namespace deltadyn
