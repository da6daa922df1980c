#include "deltadyn/model/log_cholesky.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "deltadyn/runtime/random.hpp"

namespace deltadyn {
namespace {

template <class T>
LogCholeskyVector<T> random_variables(std::mt19937& random) {
  NormalDistribution normal(0.0, 0.7);
  LogCholeskyVector<T> pi;
  for (int i = 0; i < 10; ++i) pi(i) = T(normal(random));
  return pi;
}

template <class T>
PseudoInertia<T> factor(const LogCholeskyVector<T>& pi) {
  using std::exp;
  PseudoInertia<T> U;
  U << exp(pi(1)), pi(4), pi(6), pi(7),  //
      T(0), exp(pi(2)), pi(5), pi(8),    //
      T(0), T(0), exp(pi(3)), pi(9),     //
      T(0), T(0), T(0), T(1);
  return exp(pi(0)) * U;
}

template <class T>
class LogCholeskyTest : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(LogCholeskyTest, Scalars);

TYPED_TEST(LogCholeskyTest, MapIsTheProductOfTheFactors) {
  using T = TypeParam;
  std::mt19937 random(11);
  for (int trial = 0; trial < 200; ++trial) {
    const LogCholeskyVector<T> pi = random_variables<T>(random);
    const PseudoInertia<T> U = factor(pi);
    const PseudoInertia<T> product = U.transpose() * U;
    const PseudoInertia<T> difference = to_pseudo_inertia(from_log_cholesky(pi)) - product;
    EXPECT_LT(difference.norm(), T(50) * std::numeric_limits<T>::epsilon() * product.norm());
  }
}

TEST(LogCholeskyPrintedEquation, DiffersFromTheProductWhereTheHeaderSays) {
  std::mt19937 random(12);
  const LogCholeskyVector<double> pi = random_variables<double>(random);
  const InertialVector<double> p = from_log_cholesky(pi);
  const double scale = std::exp(2.0 * pi(0)), e1 = std::exp(2.0 * pi(1)), e2 = std::exp(2.0 * pi(2)),
               e3 = std::exp(2.0 * pi(3));
  const double s12 = pi(4), s23 = pi(5), s13 = pi(6);
  EXPECT_NEAR(p(inertial::kIxx), scale * (s12 * s12 + s23 * s23 + s13 * s13 + e2 + e3), 1e-12);
  EXPECT_NEAR(p(inertial::kIyy), scale * (s13 * s13 + s23 * s23 + e1 + e3), 1e-12);
  EXPECT_NEAR(p(inertial::kIzz), scale * (s12 * s12 + e1 + e2), 1e-12);
  EXPECT_GT(std::abs(p(inertial::kIyy) - scale * (s12 * s12 + s13 * s13 + e1 + e3)), 1e-3) << "the printed Iyy";
}

TYPED_TEST(LogCholeskyTest, EveryVariableGivesAConsistentBody) {
  using T = TypeParam;
  std::mt19937 random(13);
  for (int trial = 0; trial < 1000; ++trial) {
    EXPECT_TRUE(is_physically_consistent(from_log_cholesky(random_variables<T>(random))));
  }
}

TYPED_TEST(LogCholeskyTest, InverseIsExactBothWays) {
  using T = TypeParam;
  std::mt19937 random(14);
  for (int trial = 0; trial < 500; ++trial) {
    const LogCholeskyVector<T> pi = random_variables<T>(random);
    LogCholeskyVector<T> back;
    const InertialVector<T> p = from_log_cholesky(pi);
    ASSERT_EQ(to_log_cholesky(p, back), Status::ok);
    // the way back loses the digits that the condition of U costs
    const T condition = (T(1) + pi.template tail<6>().squaredNorm()) *
                        std::exp(T(2) * (pi.template segment<3>(1).cwiseAbs().maxCoeff() + T(1)));
    const T epsilon = std::numeric_limits<T>::epsilon();
    EXPECT_LT((back - pi).norm(), T(200) * epsilon * condition * condition);
    EXPECT_LT((from_log_cholesky(back) - p).norm(), T(200) * epsilon * condition * p.norm());
  }
}

TYPED_TEST(LogCholeskyTest, InverseRefusesInconsistentBodies) {
  using T = TypeParam;
  LogCholeskyVector<T> pi = LogCholeskyVector<T>::Constant(T(7));
  InertialVector<T> p;
  p << T(1), T(0), T(0), T(0), T(0.1), T(0.1), T(0.21), T(0), T(0), T(0);
  EXPECT_EQ(to_log_cholesky(p, pi), Status::out_of_range);
  EXPECT_EQ(to_log_cholesky<T>(InertialVector<T>::Zero(), pi), Status::out_of_range);
  p(inertial::kIzz) = std::numeric_limits<T>::quiet_NaN();
  EXPECT_EQ(to_log_cholesky(p, pi), Status::out_of_range);
  p(inertial::kIzz) = T(0.1);
  p(inertial::kM) = std::numeric_limits<T>::infinity();
  EXPECT_EQ(to_log_cholesky(p, pi), Status::out_of_range);
  EXPECT_EQ(pi, LogCholeskyVector<T>::Constant(T(7))) << "an error must leave the output alone";
}

TYPED_TEST(LogCholeskyTest, JacobianAgreesWithAutomaticDifferentiation) {
  using T = TypeParam;
  using Jet = ceres::Jet<T, 10>;
  std::mt19937 random(15);
  for (int trial = 0; trial < 200; ++trial) {
    const LogCholeskyVector<T> pi = random_variables<T>(random);
    Vector<Jet, 10> variables;
    for (int i = 0; i < 10; ++i) variables(i) = Jet(pi(i), i);
    const Vector<Jet, 10> p = from_log_cholesky<Jet>(variables);
    const Matrix<T, 10, 10> J = log_cholesky_jacobian(pi);
    for (int i = 0; i < 10; ++i) {
      EXPECT_LT((J.row(i).transpose() - p(i).v).norm(), T(20) * std::numeric_limits<T>::epsilon() * J.norm())
          << "row " << i;
    }
  }
}

}  // namespace
}  // namespace deltadyn
